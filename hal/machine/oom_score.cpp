#include "hal/machine/oom_score.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <string>
#include <system_error>

#include "hal/file/descriptor.hpp"

namespace cargobay::hal {

void raise_oom_score(int least) {
  const Descriptor file{open("/proc/self/oom_score_adj", O_RDWR | O_CLOEXEC)};
  std::array<char, 8> text{};
  const ssize_t length = read(file.number(), text.data(), text.size());
  int score = 0;
  if (length <= 0) return;
  if (std::from_chars(text.data(), text.data() + length, score).ec != std::errc{}) return;
  if (score >= least) return;
  const std::string wanted = std::to_string(least);
  (void)!write(file.number(), wanted.data(), wanted.size());
}

}  // namespace cargobay::hal
