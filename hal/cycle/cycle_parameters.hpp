// How a control cycle drives: its loop, and its limits in time.
#pragma once

#include <chrono>
#include <cstdint>

#include "hal/sensing/power_watch.hpp"
#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "rt/clock.hpp"
#include "rt/odometry.hpp"
#include "rt/wheel_loop.hpp"

namespace cargobay::hal {

// What the cycle does once the robot has left its mode by itself and the cause has been reported.
enum class OnModeLoss : std::uint8_t {
  end,   // it ends
  hold,  // it goes on, driving nothing, until request_rearm() or request_stop()
};

// What the cycle does once a wheel is stuck, or the counters cannot be true, and that has been
// reported.
enum class OnImplausible : std::uint8_t {
  end,     // it stops the wheels and ends
  report,  // it goes on
};

struct CycleParameters {
  const oi::Dialect* dialect = &oi::kCreate;  // of the robot; must outlive the cycle
  // Its estimator's tick_s is the robot's tick: 15 ms, except where the cycle itself is measured.
  rt::WheelLoop::Parameters loop{};
  oi::Mode drive_mode = oi::Mode::safe;  // safe or full: where the robot must stay
  rt::Duration late_margin = std::chrono::milliseconds{5};   // after which a frame is late
  rt::Duration stop_after = std::chrono::milliseconds{150};  // of silence: the wheels are stopped
  rt::Duration link_timeout = std::chrono::seconds{1};       // of silence: the cycle ends
  rt::Duration setpoint_lapse = std::chrono::milliseconds{500};
  // For each call of the control function. At 19200 baud, frame, command and a new list take 14 of
  // the tick's 15 ms on the wire: with 2 ms more, the command still reaches the robot in its tick.
  rt::Duration control_budget = std::chrono::milliseconds{2};
  // In a row; after one more, the wheels are stopped and the cycle ends. Ten ticks are the 150 ms
  // that the robot may be silent before the wheels are stopped: steering is no worse.
  int control_overruns_allowed = 10;
  OnModeLoss on_mode_loss = OnModeLoss::end;
  OnImplausible on_implausible = OnImplausible::end;
  rt::Odometry::Parameters odometry{};
  PowerWatch::Limits power{};
};

static_assert(rt::WheelEstimator::Parameters{}.wheel_base_mm == oi::kCreate.wheel_base_mm);

// The defaults for this robot; the dialect must outlive the cycle.
inline CycleParameters defaults_for(const oi::Dialect& dialect) {
  CycleParameters parameters{.dialect = &dialect};
  parameters.loop.estimator.wheel_base_mm = dialect.wheel_base_mm;
  parameters.odometry.wheel_base_mm = dialect.wheel_base_mm;
  return parameters;
}

}  // namespace cargobay::hal
