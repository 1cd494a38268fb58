#include "hal/sim/drive_train/motion.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::hal::sim {

double Motion::speed_after(double time_s) const {
  if (slope_mm_s2 == 0.0)
    return target_mm_s + (speed_mm_s - target_mm_s) * std::exp(-time_s / lag_s);
  return target_mm_s + slope_mm_s2 * (time_s - lag_s) + excess_mm_s() * std::exp(-time_s / lag_s);
}

double Motion::travel_after(double travel_mm, double time_s) const {
  if (slope_mm_s2 == 0.0) {
    return travel_mm + target_mm_s * time_s -
           (speed_mm_s - target_mm_s) * lag_s * std::expm1(-time_s / lag_s);
  }
  return travel_mm + target_mm_s * time_s + slope_mm_s2 * time_s * (0.5 * time_s - lag_s) -
         excess_mm_s() * lag_s * std::expm1(-time_s / lag_s);
}

bool Motion::is_steady() const {
  constexpr double kNothingMmPerSec = 1e-9;
  return std::abs(excess_mm_s()) < kNothingMmPerSec;
}

double Motion::reversal(double within_s) const {
  if (slope_mm_s2 == 0.0) {
    if (!(speed_mm_s * target_mm_s < 0.0)) return kNever;
    const double time_s = lag_s * std::log1p(-speed_mm_s / target_mm_s);
    return time_s <= within_s ? time_s : kNever;
  }
  // The speed has one extremum at most, and is monotonic before and after it.
  const double ratio = excess_mm_s() / (slope_mm_s2 * lag_s);
  const double extremum_s = ratio > 1.0 ? std::min(lag_s * std::log(ratio), within_s) : 0.0;
  const double before_s = crossing(0.0, extremum_s);
  return before_s <= within_s ? before_s : crossing(extremum_s, within_s);
}

// Where the speed changes sign between two times at which it is monotonic; infinite if nowhere.
double Motion::crossing(double from_s, double to_s) const {
  const bool rises = speed_after(from_s) < 0.0;
  if (!(speed_after(from_s) * speed_after(to_s) < 0.0)) return kNever;
  constexpr int kHalvings = 60;  // as many as a double has bits, and some
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_s = 0.5 * (from_s + to_s);
    const bool before = rises ? speed_after(middle_s) < 0.0 : speed_after(middle_s) > 0.0;
    (before ? from_s : to_s) = middle_s;
  }
  return to_s;
}

}  // namespace cargobay::hal::sim
