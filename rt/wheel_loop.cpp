#include "rt/wheel_loop.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::rt {
namespace {

constexpr double kMoving = 1.0;  // mm/s: a wheel asked for more counts as moving

}  // namespace

WheelLoop::WheelLoop(const Parameters& parameters)
    : parameters_{parameters},
      estimator_{parameters.estimator},
      schedule_{parameters.schedule},
      slew_{parameters.limits},
      controller_{parameters.controller} {}

void WheelLoop::lost(int ticks, bool may_have_read) CARGOBAY_NONBLOCKING {
  constexpr int kMostSteps = 100;  // longer than any silence the cycle survives
  for (int i = 0; i < ticks && i < kMostSteps; ++i) estimator_.step_lost(command_, may_have_read);
}

void WheelLoop::frame(const std::optional<WheelEstimator::Reading>& reading) CARGOBAY_NONBLOCKING {
  estimator_.step(command_, reading);
}

// Only as much as the plant is known: one that answers later than was thought would overshoot.
double WheelLoop::proportional() const CARGOBAY_NONBLOCKING {
  constexpr double kMost = 0.7;
  constexpr double kByLag = 1.5;
  constexpr double kByGain = 4.0;
  const PlantEstimate& plant = estimator_.plant();
  const double lag_known = std::max(0.0, 1.0 - kByLag * plant.lag_sd_s / plant.lag_s);
  const double gain_known = std::max(0.0, 1.0 - kByGain * plant.gain_sd / plant.gain_left);
  const double delay_s = plant.dead_time_s + 2.0 * parameters_.estimator.tick_s;
  return kMost * lag_known * gain_known * plant.lag_s / (plant.lag_s + delay_s);
}

double WheelLoop::answer(const VelocityController::Wish& wish,
                         const VelocityController::Wheel& wheel) const CARGOBAY_NONBLOCKING {
  if (wish.set_mm_s == 0.0 && wish.target_mm_s == 0.0) return 0.0;
  const double command_mm_s =
      parameters_.feedback == Feedback::open ? wish.set_mm_s : controller_.command(wish, wheel);
  return static_cast<double>(std::lrint(command_mm_s));
}

WheelSpeeds WheelLoop::step(const WheelSpeeds& target, Steering steering) CARGOBAY_NONBLOCKING {
  const double tick_s = parameters_.estimator.tick_s;
  const WheelSpeeds set =
      steering == Steering::nobody ? slew_.brake(tick_s) : slew_.step(target, tick_s);
  const WheelSpeeds& rate = slew_.rates();
  const WheelSpeeds now = estimate();
  const WheelSpeeds disturbance = estimator_.disturbances();
  const PlantEstimate& plant = estimator_.plant();
  VelocityController::Wheel left{.gain = plant.gain_left,
                                 .gain_sd = plant.gain_sd,
                                 .lag_s = std::max(0.0, plant.lag_s - plant.lag_sd_s),
                                 .proportional = proportional(),
                                 .disturbance_mm_s = disturbance.left_mm_s,
                                 .speed_mm_s = now.left_mm_s};
  VelocityController::Wheel right = left;
  right.gain = plant.gain_right;
  right.disturbance_mm_s = disturbance.right_mm_s;
  right.speed_mm_s = now.right_mm_s;
  command_ = {answer({set.left_mm_s, rate.left_mm_s, target.left_mm_s}, left),
              answer({set.right_mm_s, rate.right_mm_s, target.right_mm_s}, right)};
  return command_;
}

void WheelLoop::stop() CARGOBAY_NONBLOCKING {
  command_ = {};
  slew_.reset({});
  estimator_.doubt_command();
}

bool WheelLoop::next_reads() CARGOBAY_NONBLOCKING {
  using Motion = ReadSchedule::Motion;
  const bool moving =
      std::abs(command_.left_mm_s) > kMoving || std::abs(command_.right_mm_s) > kMoving;
  const bool changing = slew_.rates() != WheelSpeeds{};
  // A robot that still rolls must not be read tick by tick unless it carries the remainder.
  const bool rolls = !moving && !estimator_.rests();
  return schedule_.next_reads(belief(), estimator_.sure(),
                              !moving && !rolls   ? Motion::none
                              : changing || rolls ? Motion::changing
                                                  : Motion::steady);
}

}  // namespace cargobay::rt
