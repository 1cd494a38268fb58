// The end of a drive, however it came: the robot stands, and charges if it can.
#pragma once

#include <chrono>

#include "hal/byte_stream.hpp"

namespace cargobay::hal {

// What host software for this robot waits after Start, Safe and Full: from 20 to 500 ms.
inline constexpr std::chrono::milliseconds kModeChangeWait{50};

// Stops the wheels, ends the stream, goes Passive and waits for the robot to say so: true. Blocks
// for up to 1 s. False where the robot does not answer; it was told all the same.
bool leave(ByteStream& stream);

}  // namespace cargobay::hal
