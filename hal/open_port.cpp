#include "hal/open_port.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <filesystem>

#include "hal/pty_transport.hpp"

namespace cargobay::hal {
namespace {

// The kernel's numbers for the slave sides of pseudo-terminals (Documentation/admin-guide/devices).
constexpr unsigned kFirstPtyMajor = 136;
constexpr unsigned kLastPtyMajor = 143;

bool is_pty(const std::string& path) {
  struct stat file{};
  if (stat(path.c_str(), &file) != 0 || !S_ISCHR(file.st_mode)) return false;
  return major(file.st_rdev) >= kFirstPtyMajor && major(file.st_rdev) <= kLastPtyMajor;
}

}  // namespace

Result<OpenedPort> open_port(const std::string& path, std::uint32_t baud) {
  if (is_pty(path)) {
    auto stream = open_pty(path, baud);
    if (!stream) return stream.failure();
    return OpenedPort{.stream = std::move(*stream)};
  }
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  // What cannot be followed is refused by its own name.
  return open_serial(error ? path : real.string(), baud);
}

}  // namespace cargobay::hal
