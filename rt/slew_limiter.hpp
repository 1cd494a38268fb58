// Limits how fast a wheel's set speed changes, and how fast that change builds up.
#pragma once

#include <algorithm>
#include <cmath>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

// One thread; no allocation. If the target is constant, the set speed reaches it exactly and never
// overshoots. If it moves, the acceleration in progress may be too much for it: the excess is
// dropped at once, whatever the jerk limit, so that a wheel asked to slow down does not speed up
// first.
class SlewLimiter {
 public:
  struct Limits {
    double acceleration_mm_s2 = 1000.0;  // above 0
    double jerk_mm_s3 = 0.0;             // how fast the acceleration may grow; 0: at once
  };
  // At which a wheel is slowed down that nobody steers, if its limit is not higher.
  static constexpr double kBrakeMmS2 = 1000.0;

  explicit SlewLimiter(const Limits& limits) : limits_{limits} {}

  // Stays at that speed from now on, whatever the limits: also for the stop that must not wait.
  void reset(double speed_mm_s) CARGOBAY_NONBLOCKING {
    speed_mm_s_ = speed_mm_s;
    rate_mm_s2_ = 0.0;
  }

  // One step of `step_s` seconds towards the target. Returns the speed to follow.
  double step(double target_mm_s, double step_s) CARGOBAY_NONBLOCKING {
    const double way_mm_s = target_mm_s - speed_mm_s_;
    return change(way_mm_s, most_change(way_mm_s, step_s), target_mm_s, step_s);
  }
  // One step towards standstill, for a wheel that nobody steers: however gentle the limits, it does
  // not roll far.
  double brake(double step_s) CARGOBAY_NONBLOCKING {
    const double most_mm_s = std::max(limits_.acceleration_mm_s2, kBrakeMmS2) * step_s;
    return change(-speed_mm_s_, most_mm_s, 0.0, step_s);
  }
  double speed_mm_s() const CARGOBAY_NONBLOCKING { return speed_mm_s_; }
  // Acceleration of the last step.
  double rate_mm_s2() const CARGOBAY_NONBLOCKING { return rate_mm_s2_; }

 private:
  double change(double way_mm_s, double most_mm_s, double target_mm_s, double step_s)
      CARGOBAY_NONBLOCKING {
    const double change_mm_s = std::clamp(way_mm_s, -most_mm_s, most_mm_s);
    // Adding the difference could miss the target by a rounding error.
    speed_mm_s_ = change_mm_s == way_mm_s ? target_mm_s : speed_mm_s_ + change_mm_s;
    rate_mm_s2_ = change_mm_s / step_s;
    return speed_mm_s_;
  }

  // The greatest change towards the target in this step, unsigned.
  double most_change(double way_mm_s, double step_s) const CARGOBAY_NONBLOCKING {
    const double most_mm_s = limits_.acceleration_mm_s2 * step_s;
    if (limits_.jerk_mm_s3 <= 0.0) return most_mm_s;
    const double growth_mm_s = limits_.jerk_mm_s3 * step_s * step_s;
    const double former_mm_s = (way_mm_s < 0.0 ? -rate_mm_s2_ : rate_mm_s2_) * step_s;
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
  double speed_mm_s_ = 0.0;
  double rate_mm_s2_ = 0.0;
};

}  // namespace cargobay::rt
