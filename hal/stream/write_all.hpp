// For set-up and shutdown: a write that is not content with a part.
#pragma once

#include <cstdint>
#include <span>

#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// Writes all of `bytes`, and waits for room where the port's queue is full, for 200 ms at most in
// all. Looks before each write whether the stream is still the port that was opened. A call that
// fails is made once more: one error proves nothing. False if the port did not take all; the robot
// may then wait for the rest of a command. No allocation.
[[nodiscard]] bool write_all(ByteStream& stream, std::span<const std::uint8_t> bytes);

}  // namespace cargobay::hal
