#include "hal/open_port.hpp"

#include <filesystem>

#include "hal/pty_transport.hpp"

namespace cargobay::hal {

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
