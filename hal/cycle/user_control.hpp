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
  explicit UserControl(const Limits& limits) : limits_{limits} {}

  void set(const ControlFunction& control) { control_ = control; }
  bool is_set() const CARGOBAY_NONBLOCKING { return control_.function != nullptr; }

  // What it wants; to stand still if no robot can follow that: refusal() says so.
  ControlAnswer ask(const CycleState& state) CARGOBAY_NONBLOCKING {
    const double seconds = static_cast<double>(state.tick) * rt::seconds(limits_.tick);
    const ControlAnswer wanted = control_.function(control_.context, state, seconds);
    const bool speeds = wanted.kind() == ControlAnswer::Kind::speeds;
    if (!speeds || within_range(wanted.speeds())) {
      refusal_ = Refusal::none;
      return wanted;
    }
    refusal_ = refusal_ == Refusal::none ? Refusal::first : Refusal::another;
    return ControlAnswer::Kind::stand;
  }
  enum class Refusal : std::uint8_t { none, first, another };  // in a row
  // Of the last answer.
  Refusal refusal() const CARGOBAY_NONBLOCKING { return refusal_; }

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
  Refusal refusal_ = Refusal::none;
};

}  // namespace cargobay::hal
