#include "hal/port/open_port.hpp"

#include <filesystem>

#include "hal/port/pty_transport.hpp"
#include "hal/stream/spaced_stream.hpp"

namespace cargobay::hal {

namespace {

Result<OpenedPort> open_either(const std::string& path, std::uint32_t baud) {
  if (is_pty(path)) {
    auto stream = open_pty(path, baud);
    if (!stream) return stream.failure();
    return OpenedPort{.stream = std::move(*stream)};
  }
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  // A path that cannot be resolved is refused under its own name.
  return open_serial(error ? path : real.string(), baud);
}

}  // namespace

Result<OpenedPort> open_port(const std::string& path, std::uint32_t baud) {
  auto opened = open_either(path, baud);
  if (opened) opened->stream = std::make_unique<SpacedStream>(std::move(opened->stream));
  return opened;
}

}  // namespace cargobay::hal
