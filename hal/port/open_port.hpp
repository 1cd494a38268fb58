// Opens whatever port a path names.
#pragma once

#include <cstdint>
#include <string>

#include "hal/port/serial_transport.hpp"

namespace cargobay::hal {

// For a robot (hal/stream/spaced_stream.hpp). A pseudo-terminal, which libserialport refuses, is
// opened by open_pty(); any other port by open_serial(). Links, such as /dev/serial0 or those under
// /dev/serial/by-id, are followed.
Result<OpenedPort> open_port(const std::string& path, std::uint32_t baud);

}  // namespace cargobay::hal
