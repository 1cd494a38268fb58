// What the wheel estimator would have made of a recorded drive with other parameters: from the same
// readings, with the robot doing what it was told then.
#pragma once

#include <cstdint>

#include "hal/recording/recording.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

struct EstimateDifference {
  std::uint64_t ticks = 0;
  rt::WheelSpeeds rms{};   // of the new estimate minus the recorded one
  rt::WheelSpeeds most{};  // the largest, unsigned
  rt::RemainderBelief recorded_belief = rt::RemainderBelief::unknown;  // at the end
  rt::RemainderBelief belief = rt::RemainderBelief::unknown;           // the same
};

// Compares up to the first missing block. With the recording's own parameters, and on a line that
// nothing disturbed, there is no difference. Whether a lost frame read the counters is not
// recorded, and is inferred from the frames around it; a silence is accounted for at its end.
EstimateDifference estimate_again(const Recording& recording,
                                  const rt::WheelEstimator::Parameters& parameters);

}  // namespace cargobay::hal
