// A serial port using POSIX termios alone: pseudo-terminals, which libserialport refuses, and any
// other terminal device.
#pragma once

#include <memory>
#include <string>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// Whether `path` leads to the slave side of a pseudo-terminal.
bool is_pty(const std::string& path);

// Opens `path`, 8N1, raw, no flow control, at a baud rate of oi/baud.hpp, for this process alone: a
// second opener is refused, even root. What had arrived before is dropped. Blocks only as long as
// open() does; allocates. The port is released when the stream is destroyed.
Result<std::unique_ptr<ByteStream>> open_pty(const std::string& path, std::uint32_t baud);

}  // namespace cargobay::hal
