// How far the robot has gone, by what the estimator knows of its axes.
#include <algorithm>
#include <utility>

#include "rt/wheel_estimator.hpp"

namespace cargobay::rt {

TurnObserver::Begin WheelEstimator::gains() const CARGOBAY_NONBLOCKING {
  const PlantEstimate& plant = bank_.estimate();
  return {.gain_difference = plant.gain_right - plant.gain_left,
          .gain_difference_sd = plant.gain_difference_sd};
}

// Not as long as the robot surely carries the remainder.
void WheelEstimator::follow_turn(const AxisFilter::Response& response,
                                 const AxisFilter::Doubt& doubt) CARGOBAY_NONBLOCKING {
  if (sure() && belief_ == RemainderBelief::carried) {
    follows_turns_ = false;
    return;
  }
  if (!std::exchange(follows_turns_, true)) {
    turns_.resume(gains(), lost_.turn.speed_mm_s(), lost_.turn.speed_variance());
  }
  const PlantEstimate& plant = bank_.estimate();
  turns_.step({.wheels = bank_.driven(),
               .gain = (plant.gain_left + plant.gain_right) / 2.0,
               .gain_sd = plant.gain_sd},
              response, doubt);
}

Course::Ways WheelEstimator::ways() const CARGOBAY_NONBLOCKING {
  const auto of = [](double mean_mm, double turn_mm) CARGOBAY_NONBLOCKING {
    return WheelSpeeds{mean_mm - turn_mm / 2.0, mean_mm + turn_mm / 2.0};
  };
  return {.if_carried = of(carried_.distance.travel_mm(), carried_.turn.travel_mm()),
          .if_lost = of(lost_.distance.travel_mm(), turns_.turn_mm()),
          .corrected_mm = just_corrected_mm_};
}

Travel WheelEstimator::take_travel(Hypothesis& hypothesis) const CARGOBAY_NONBLOCKING {
  const double base = parameters_.wheel_base_mm;
  const Taken now{.distance_mm = hypothesis.distance.travel_mm(),
                  .turn_mm = hypothesis.turn.travel_mm(),
                  .distance_variance = hypothesis.distance.forgotten_variance(),
                  .turn_variance = hypothesis.turn.forgotten_variance()};
  const Taken former = std::exchange(hypothesis.taken, now);
  // While the speed is steady, successive readings lose alike, and their errors add up.
  constexpr double kAlike = 3.0;
  return {.distance_mm = now.distance_mm - former.distance_mm,
          .turn_rad = (now.turn_mm - former.turn_mm) / base,
          .distance_variance = kAlike * (now.distance_variance - former.distance_variance),
          .turn_variance = kAlike * (now.turn_variance - former.turn_variance) / (base * base),
          .unread_distance_variance = hypothesis.distance.unread_variance(),
          .unread_turn_variance = hypothesis.turn.unread_variance() / (base * base)};
}

// In place of what the axis says by itself.
void WheelEstimator::observe_turn(Travel& travel) CARGOBAY_NONBLOCKING {
  if (!follows_turns_) return;
  const double base = parameters_.wheel_base_mm;
  // What one tick adds does not depend on the other ticks, as the odometry has it; but it does.
  constexpr double kAlike = 1.5;
  // A reading may settle what was uncertain of the way before, too; the pose does not learn that.
  const double settled = std::max(turns_.settled_variance(), taken_turns_.turn_variance);
  const Taken now{.turn_mm = turns_.turn_mm(), .turn_variance = settled};
  const Taken former = std::exchange(taken_turns_, now);
  travel.turn_rad = (now.turn_mm - former.turn_mm) / base;
  travel.turn_corrected_rad = std::exchange(corrected_mm_, 0.0) / base;
  travel.turn_variance = kAlike * (now.turn_variance - former.turn_variance) / (base * base);
  travel.unread_turn_variance =
      std::max(0.0, turns_.turn_variance() - turns_.settled_variance()) / (base * base);
}

Travels WheelEstimator::take_travels() CARGOBAY_NONBLOCKING {
  Travels travels{.if_carried = take_travel(carried_), .if_lost = take_travel(lost_)};
  observe_turn(travels.if_lost);
  return travels;
}

}  // namespace cargobay::rt
