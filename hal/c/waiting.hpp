// Waiting for the loop.
#pragma once

#include <cstdint>

#include "hal/c/robot_object.hpp"
#include "rt/clock.hpp"

namespace cargobay::c {

// The end of the wait on a clock that says `now`; negative: never.
rt::TimePoint deadline(rt::TimePoint now, std::int64_t timeout_ns);

// Blocks until there is a state after `after_tick`: CARGOBAY_OK and the state, or as
// cargobay_wait().
int wait_for_frame(RobotObject& object, std::int64_t after_tick, std::int64_t timeout_ns,
                   SeenState& seen);

int no_frame_yet() noexcept;

}  // namespace cargobay::c
