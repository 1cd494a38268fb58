#include "rt/kernel_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>

namespace cargobay::rt {

// Not by std::ifstream, whose buffer throws if a read fails.
std::string kernel_file(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (file < 0) return "";
  std::string text;
  std::array<char, 4096> part{};
  ssize_t count = 0;
  while ((count = read(file, part.data(), part.size())) > 0)
    text.append(part.data(), static_cast<std::size_t>(count));
  close(file);
  return count < 0 ? "" : text;
}

}  // namespace cargobay::rt
