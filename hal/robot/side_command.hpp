// Commands that others want the robot to get while the loop drives it: LEDs, songs, outputs,
// scripts.
#pragma once

#include <cstdint>
#include <span>

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/request.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

// Whether the bytes, one whole command with values in range, may go out beside the loop's. A
// failure, with invalid_argument, if the loop sends such commands itself, or it would take the
// robot out of the loop's hands. Allocates only for a failure.
Result<void> leaves_loop_alone(std::span<const std::uint8_t> command);

// The request to send it after the loop's own: one whole command that leaves the loop alone. A
// failure if the robot would not obey it in its present mode (operation_not_permitted), or if it is
// too long to go out while the wheels turn, unless the loop may pause (no_buffer_space). From any
// thread; allocates only for a failure.
Result<Request> side_request(const ControlCycle& cycle, std::span<const std::uint8_t> command,
                             Request::WhenLong when_long);

}  // namespace cargobay::hal
