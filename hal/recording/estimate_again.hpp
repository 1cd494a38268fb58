// What the wheel estimator would have made of a recorded drive with other parameters: of the same
// readings, while the robot did what it was told then.
#pragma once

#include <cstdint>

#include "hal/recording/recording.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

struct EstimateDifference {
  std::uint64_t ticks = 0;
  rt::WheelSpeeds rms{};   // of the new estimate minus the recorded one
  rt::WheelSpeeds most{};  // the largest, without its sign
  rt::RemainderBelief recorded_belief = rt::RemainderBelief::unknown;  // at the end
  rt::RemainderBelief belief = rt::RemainderBelief::unknown;           // the same
};

// Compares up to the first missing block. With the recording's own parameters, and on a line that
// nothing disturbed, there is no difference; of a lost frame it is not recorded whether it read the
// counters, and those around it tell; a silence is accounted for at its end.
EstimateDifference estimate_again(const Recording& recording,
                                  const rt::WheelEstimator::Parameters& parameters);

}  // namespace cargobay::hal
