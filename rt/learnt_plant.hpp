// What a drive has learnt of the wheels and how sure it is, for people to read and for the next
// drive to begin from.
#pragma once

#include "rt/remainder.hpp"

namespace cargobay::rt {

// Means and standard deviations.
struct LearntPlant {
  double lag_s = 0.100;  // above 0
  double lag_sd_s = 0.0;
  double dead_time_s = 0.0;
  double dead_time_sd_s = 0.0;
  double ramp_s2_mm = 0.0;  // 1 / ramp; 0: none
  double ramp_sd_s2_mm = 0.0;
  // True mm/s for each commanded mm/s once all has settled; above 0.
  double gain_left = 0.92;
  double gain_left_sd = 0.0;
  double gain_right = 0.92;
  double gain_right_sd = 0.0;
  RemainderBelief remainder = RemainderBelief::unknown;
  double log_odds_carried = 0.0;  // evidence for `carried` over `lost`, natural logarithm
  double moved_s = 0.0;           // how long the wheels were told to move meanwhile
};

}  // namespace cargobay::rt
