// How a first-order lag answers a target that stands still or moves along a straight line, in
// closed form: speed' = (target + slope * t - speed) / lag.
#pragma once

#include <limits>

namespace cargobay::hal::sim {

struct Motion {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  double speed_mm_s = 0.0;  // at its beginning
  double target_mm_s = 0.0;
  double slope_mm_s2 = 0.0;  // of the target
  double lag_s = 0.1;        // above 0

  // `time_s` is not negative.
  double speed_after(double time_s) const;
  // How far it has come then, from `travel_mm`.
  double travel_after(double travel_mm, double time_s) const;
  // When its speed changes sign for the first time, if within that time; infinite otherwise.
  double reversal(double within_s) const;
  // What it began with is over: it follows its target on a straight line.
  bool is_steady() const;

 private:
  double excess_mm_s() const { return speed_mm_s - target_mm_s + slope_mm_s2 * lag_s; }
  double crossing(double from_s, double to_s) const;
};

}  // namespace cargobay::hal::sim
