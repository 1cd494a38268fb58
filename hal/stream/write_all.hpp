// For set-up and shutdown: a write that does not settle for a part.
#pragma once

#include <cstdint>
#include <span>

#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// Writes all of `bytes`, waiting for room while the port's queue is full, for 200 ms at most in
// total. Checks before each write that the stream is still the port that was opened. A failed call
// is repeated once: one error proves nothing. False if the port did not take everything; the robot
// may then wait for the rest of a command. No allocation.
[[nodiscard]] bool write_all(ByteStream& stream, std::span<const std::uint8_t> bytes);

}  // namespace cargobay::hal
