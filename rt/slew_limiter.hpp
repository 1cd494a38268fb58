// Limits how fast the set speeds of the wheels change, and how fast that change builds up.
#pragma once

#include <algorithm>
#include <cmath>

#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

// One thread; no allocation. Both wheels change in proportion, so that they arrive together: from
// standing, the robot keeps to the curve that it is asked for. If the targets are constant, the set
// speeds reach them exactly and never overshoot. If they move, the acceleration in progress may be
// too much for them: the excess is dropped at once, whatever the jerk limit, so that a wheel asked
// to slow down does not speed up first.
class SlewLimiter {
 public:
  struct Limits {
    double acceleration_mm_s2 = 1000.0;  // above 0; of the wheel that changes more
    double jerk_mm_s3 = 0.0;             // how fast the acceleration may grow; 0: at once
  };

  explicit SlewLimiter(const Limits& limits) : limits_{limits} {}

  // Stays at these speeds from now on, whatever the limits: also for the stop that must not wait.
  void reset(const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
    speeds_ = speeds;
    rates_ = {};
  }

  // One step of `step_s` seconds towards the target. Returns the speeds to follow.
  WheelSpeeds step(const WheelSpeeds& target, double step_s) CARGOBAY_NONBLOCKING {
    const double left_mm_s = target.left_mm_s - speeds_.left_mm_s;
    const double right_mm_s = target.right_mm_s - speeds_.right_mm_s;
    const bool left_leads = std::abs(left_mm_s) >= std::abs(right_mm_s);
    const double way_mm_s = left_leads ? left_mm_s : right_mm_s;
    const double rate_mm_s2 = left_leads ? rates_.left_mm_s : rates_.right_mm_s;
    const double most_mm_s = most_change(way_mm_s, rate_mm_s2, step_s);
    const WheelSpeeds former = speeds_;
    // Adding the difference could miss the target by a rounding error.
    if (std::abs(way_mm_s) <= most_mm_s) {
      speeds_ = target;
    } else {
      const double part = most_mm_s / std::abs(way_mm_s);
      speeds_ = {former.left_mm_s + part * left_mm_s, former.right_mm_s + part * right_mm_s};
    }
    rates_ = {(speeds_.left_mm_s - former.left_mm_s) / step_s,
              (speeds_.right_mm_s - former.right_mm_s) / step_s};
    return speeds_;
  }
  // Where step() would be `seconds` later, if the target stayed. Changes nothing.
  SlewLimiter ahead(const WheelSpeeds& target, double seconds, double step_s) const
      CARGOBAY_NONBLOCKING {
    SlewLimiter later{*this};
    while (seconds > 0.0) {
      later.step(target, std::min(seconds, step_s));
      seconds -= step_s;
    }
    return later;
  }
  const WheelSpeeds& speeds() const CARGOBAY_NONBLOCKING { return speeds_; }
  // Accelerations of the last step, mm/s^2.
  const WheelSpeeds& rates() const CARGOBAY_NONBLOCKING { return rates_; }

 private:
  // The greatest change towards the target in this step, unsigned.
  double most_change(double way_mm_s, double rate_mm_s2, double step_s) const CARGOBAY_NONBLOCKING {
    const double most_mm_s = limits_.acceleration_mm_s2 * step_s;
    if (limits_.jerk_mm_s3 <= 0.0) return most_mm_s;
    const double growth_mm_s = limits_.jerk_mm_s3 * step_s * step_s;
    const double former_mm_s = (way_mm_s < 0.0 ? -rate_mm_s2 : rate_mm_s2) * step_s;
    return std::min({most_mm_s, std::max(0.0, former_mm_s) + growth_mm_s,
                     fading_change(std::abs(way_mm_s), growth_mm_s)});
  }

  // The change that, reduced by `growth_mm_s` in each later step, reaches 0 when all steps together
  // have covered `way_mm_s`: it takes part in n + 1 of them, less 1 + 2 + ... + n times the growth.
  static double fading_change(double way_mm_s, double growth_mm_s) CARGOBAY_NONBLOCKING {
    const double n = std::floor((std::sqrt(1.0 + 8.0 * way_mm_s / growth_mm_s) - 1.0) / 2.0);
    return way_mm_s / (n + 1.0) + growth_mm_s * n / 2.0;
  }

  Limits limits_;
  WheelSpeeds speeds_{};
  WheelSpeeds rates_{};
};

}  // namespace cargobay::rt
