// The guard's one deed.
#pragma once

#include <cstdint>

namespace cargobay::hal {

// On the terminal `descriptor`, which somebody left in the middle of a command of at most
// `in_writing` bytes: completes it, stops the wheels, ends the stream, makes the robot Passive, and
// asks whether it is. What was never sent is dropped where it would take long. Tries three times,
// 0.8 s at most. True where the robot itself said that it is Passive, or off.
bool stop_robot(int descriptor, std::uint32_t in_writing);

}  // namespace cargobay::hal
