// Which readings the estimator believes, and which it doubts.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "rt/wheel_estimator.hpp"

namespace cargobay::rt {
namespace {

constexpr double kMostSpeed = 600.0;  // mm/s, a fifth above the robot's range
constexpr double kSlackSteps = 2.0;   // of the counter

}  // namespace

WheelEstimator::Miss WheelEstimator::miss(Axis axis, double count) const CARGOBAY_NONBLOCKING {
  const bool turns = axis == Axis::turn;
  const Hypothesis& likely = log_odds_ > 0.0 ? carried_ : lost_;
  const AxisFilter& filter = turns ? likely.turn : likely.distance;
  const double step_mm = turns ? parameters_.wheel_base_mm * std::numbers::pi / 180.0 : 1.0;
  const double foreseen_mm = filter.unread_mm();
  return {std::abs(count * step_mm - foreseen_mm), std::abs(foreseen_mm),
          std::sqrt(filter.unread_variance()), step_mm};
}

// Whether it is far from all that was foreseen. Once, that is noise on the line or a robot that was
// pushed; twice in a row, it is so.
bool WheelEstimator::surprising(Axis axis, int count) const CARGOBAY_NONBLOCKING {
  const Miss off = miss(axis, count);
  return off.mm > 8.0 * off.sd_mm + 0.5 * off.foreseen_mm + 3.0 * off.step_mm;
}

// Whether a surprising way is more than was foreseen, or back. Less may be a wheel that stands, and
// an angle a counter that does: of these the watch must hear at once.
bool WheelEstimator::wild(const Reading& reading) const CARGOBAY_NONBLOCKING {
  if (!reading.distance_mm || distance_.surprised) return false;
  const int count = *reading.distance_mm;
  const double foreseen_mm = (log_odds_ > 0.0 ? carried_ : lost_).distance.unread_mm();
  return surprising(Axis::distance, count) &&
         (count * foreseen_mm < 0.0 || std::abs(count) > std::abs(foreseen_mm));
}

// Whether it is less than that far, but as far as a wheel makes it that stands or counts half. A
// robot that carries the remainder is read every tick anyway, so nobody needs to know.
bool WheelEstimator::strange(Axis axis, int count) const CARGOBAY_NONBLOCKING {
  if (belief_ != RemainderBelief::lost || !sure() || !bank_.steady()) return false;
  const Miss off = miss(axis, count == 0 ? 0.0 : count + std::copysign(0.5, count));
  const WheelSpeeds now = speeds();
  const double mean_mm =
      parameters_.tick_s * (std::abs(now.left_mm_s) + std::abs(now.right_mm_s)) / 2.0;
  const double way_mm = mean_mm * (axis == Axis::turn ? 2 * turn_.ticks : distance_.ticks);
  return off.mm > 0.25 * way_mm + 0.6 * off.step_mm + off.sd_mm;
}

// Whether a robot at full speed, and then some, could have gone this far since the last readings.
bool WheelEstimator::plausible(const Reading& reading) const CARGOBAY_NONBLOCKING {
  const auto most_mm = [&](const Counter& counter) CARGOBAY_NONBLOCKING {
    return kMostSpeed * parameters_.tick_s * counter.ticks + kSlackSteps;
  };
  const double most_deg =
      2.0 * most_mm(turn_) / parameters_.wheel_base_mm * 180.0 / std::numbers::pi + kSlackSteps;
  return std::abs(reading.distance_mm.value_or(0)) <= most_mm(distance_) &&
         std::abs(reading.angle_deg.value_or(0)) <= most_deg;
}

}  // namespace cargobay::rt
