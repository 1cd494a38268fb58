// What is at the other end of a line on which no robot answers, for commands that ask without a
// bring-up.
#pragma once

#include <functional>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// Names it in the words of a bring-up: a login prompt, a GPS receiver, the command's own echo, a
// robot that charges; and another process that has the port open. `silent` is what to say
// otherwise; a failure whose code is not Trouble::silent is returned as it is. Asks twice for a
// sensor value at the present rate, which moves no robot, and listens for 1.2 s, or until a line is
// known. If something comes that is not text, it does the same at the rates of other devices, for
// 10 s in all at most; in the end the rate is the present one again. `cancelled` is called every
// 20 ms, and ends that; may be empty. Allocates.
Failure name_other_end(ByteStream& stream, const Failure& silent,
                       const std::function<bool()>& cancelled);

}  // namespace cargobay::hal
