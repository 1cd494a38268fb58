// The control function of the driving program: its answers, and how long they take.
#pragma once

#include <cmath>
#include <cstdint>

#include "hal/cycle/cycle_state.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

// False also for speeds that are not numbers.
inline bool within_range(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  constexpr double kMost = oi::kMaxWheelSpeed;
  return std::abs(speeds.left_mm_s) <= kMost && std::abs(speeds.right_mm_s) <= kMost;
}

// One thread; no allocation.
class UserControl {
 public:
  struct Limits {
    rt::Duration tick;     // of the robot
    rt::Duration budget;   // for each call
    int overruns_allowed;  // in a row
  };
  struct Answer {
    rt::WheelSpeeds speeds{};  // 0 if refused: no robot can follow them
    bool refused = false;
    bool first = false;  // the first in a row of refused ones
  };

  explicit UserControl(const Limits& limits) : limits_{limits} {}

  void set(const ControlFunction& control) { control_ = control; }
  bool is_set() const CARGOBAY_NONBLOCKING { return control_.function != nullptr; }

  Answer ask(const CycleState& state) CARGOBAY_NONBLOCKING {
    const double seconds = static_cast<double>(state.tick) * rt::seconds(limits_.tick);
    const rt::WheelSpeeds speeds = control_.function(control_.context, state, seconds);
    const bool sane = within_range(speeds);
    const bool was_sane = was_sane_;
    was_sane_ = sane;
    if (sane) return {.speeds = speeds};
    return {.refused = true, .first = was_sane};
  }

  // Call once a tick. Whether the call took longer than allowed.
  bool over_budget(rt::Duration took) CARGOBAY_NONBLOCKING {
    const bool over = is_set() && took > limits_.budget;
    overruns_in_a_row_ = over ? overruns_in_a_row_ + 1 : 0;
    return over;
  }
  bool too_many_overruns() const CARGOBAY_NONBLOCKING {
    return overruns_in_a_row_ > limits_.overruns_allowed;
  }

 private:
  ControlFunction control_{};
  Limits limits_;
  int overruns_in_a_row_ = 0;
  bool was_sane_ = true;
};

}  // namespace cargobay::hal
