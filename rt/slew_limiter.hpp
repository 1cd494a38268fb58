// Limits how fast a wheel's set speed changes.
#pragma once

#include <algorithm>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class SlewLimiter {
 public:
  // Above 0, in mm/s^2.
  explicit SlewLimiter(double acceleration_mm_s2) : acceleration_mm_s2_{acceleration_mm_s2} {}

  void reset(double speed_mm_s) noexcept CARGOBAY_NONBLOCKING {
    speed_mm_s_ = speed_mm_s;
    rate_mm_s2_ = 0.0;
  }

  // One step of `step_s` seconds towards the target. Returns the speed to follow.
  double step(double target_mm_s, double step_s) noexcept CARGOBAY_NONBLOCKING {
    const double most = acceleration_mm_s2_ * step_s;
    const double change = std::clamp(target_mm_s - speed_mm_s_, -most, most);
    speed_mm_s_ += change;
    rate_mm_s2_ = change / step_s;
    return speed_mm_s_;
  }
  double speed_mm_s() const noexcept CARGOBAY_NONBLOCKING { return speed_mm_s_; }
  // Acceleration of the last step.
  double rate_mm_s2() const noexcept CARGOBAY_NONBLOCKING { return rate_mm_s2_; }

 private:
  double acceleration_mm_s2_;
  double speed_mm_s_ = 0.0;
  double rate_mm_s2_ = 0.0;
};

}  // namespace cargobay::rt
