#include "rt/wheel_loop.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::rt {
namespace {

constexpr double kMoving = 1.0;  // mm/s: a wheel asked for more counts as moving
// Half a tick, since the set speed goes on meanwhile, and the way of a command to the robot.
constexpr double kActsLaterTicks = 0.67;
constexpr int kSuspectTicks = 40;

}  // namespace

WheelLoop::WheelLoop(const Parameters& parameters)
    : parameters_{parameters},
      estimator_{parameters.estimator},
      watch_{{.wheel_base_mm = parameters.estimator.wheel_base_mm,
              .tick_s = parameters.estimator.tick_s,
              .input_delay_s = parameters.estimator.input_delay_s}},
      schedule_{parameters.schedule},
      slew_{parameters.limits},
      course_{parameters.course},
      controller_{parameters.controller} {}

void WheelLoop::lost(int ticks, const Axes& may_have_read) CARGOBAY_NONBLOCKING {
  constexpr int kMostSteps = 100;  // longer than any silence the cycle survives
  for (int i = 0; i < ticks && i < kMostSteps; ++i) {
    estimator_.step_lost(command_, may_have_read);
    watch_.step(command_, estimator_.plant());
  }
  // What was gone meanwhile is hardly known: no curve is to be kept by it.
  constexpr int kSilence = 20;
  if (ticks > kSilence && !parameters_.course.hold_heading) course_.forget();
}

void WheelLoop::frame(const WheelEstimator::Reading& reading) CARGOBAY_NONBLOCKING {
  estimator_.step(command_, reading);
  using How = WheelEstimator::Seen::How;
  const WheelEstimator::Seen& seen = estimator_.seen();
  if (seen.how == How::past) return;
  watch_.step(command_, estimator_.plant());
  suspicious_ticks_ = suspicious() ? kSuspectTicks : std::max(suspicious_ticks_ - 1, 0);
  switch (seen.how) {
    case How::none:
    case How::past: return;
    case How::wild:
    case How::unsure: return watch_.read_unseen(reading.axes());
    case How::impossible: return watch_.read_impossible(reading.axes());
    case How::believed: break;
  }
  watch_.read({.distance_mm = reading.distance_mm,
               .angle_deg = reading.angle_deg,
               .distance_ticks = seen.distance_ticks,
               .turn_ticks = seen.turn_ticks},
              estimator_.belief());
}

// Whether what was learnt looks as if a counter or a wheel had failed. A robot that loses the
// remainder is read for the watch only then.
bool WheelLoop::suspicious() const CARGOBAY_NONBLOCKING {
  constexpr double kWeak = 0.55;
  constexpr double kMostUnlike = 0.4;
  const PlantEstimate& plant = estimator_.plant();
  const double mean = (plant.gain_left + plant.gain_right) / 2.0;
  return estimator_.surprised() || estimator_.seen().strange || mean < kWeak ||
         std::abs(plant.gain_left - plant.gain_right) > kMostUnlike * mean;
}

bool WheelLoop::suspects() const CARGOBAY_NONBLOCKING {
  return watch_.suspects() ||
         (suspicious_ticks_ > 0 && estimator_.belief() != RemainderBelief::carried);
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

// The fastest that a wheel of this gain can be driven at for that target; within the robot's range,
// with some room left to correct it.
double WheelLoop::reach(double target_mm_s, double gain) const CARGOBAY_NONBLOCKING {
  constexpr double kRoom = 0.985;
  return gain * std::min(kRoom * parameters_.controller.max_command_mm_s,
                         VelocityController::most_mm_s(target_mm_s));
}

// Of the set speeds, one factor for both wheels. As long as a gain is not known, it may be the
// better one.
double WheelLoop::reachable_part(const WheelSpeeds& set, const WheelSpeeds& target)
    CARGOBAY_NONBLOCKING {
  if (parameters_.feedback == Feedback::open) return 1.0;
  const PlantEstimate& plant = estimator_.plant();
  const auto part_of = [&](double set_mm_s, double target_mm_s, double gain) CARGOBAY_NONBLOCKING {
    const double most = std::max(std::abs(set_mm_s), std::abs(target_mm_s));
    const double reach_mm_s = reach(most, gain + plant.gain_sd);
    return std::abs(set_mm_s) > reach_mm_s ? reach_mm_s / std::abs(set_mm_s) : 1.0;
  };
  const double part = std::min(part_of(set.left_mm_s, target.left_mm_s, plant.gain_left),
                               part_of(set.right_mm_s, target.right_mm_s, plant.gain_right));
  // What is learnt moves a little all the time; the wheels need not follow.
  constexpr double kSame = 0.005;
  if (part < 1.0 && std::abs(part - part_) < kSame) return part_;
  return part;
}

Course::Known WheelLoop::known() const CARGOBAY_NONBLOCKING {
  constexpr double kKnown = 0.01;
  const PlantEstimate& plant = estimator_.plant();
  return {.carried = estimator_.carried(), .gains = plant.gain_sd < kKnown * plant.gain_left};
}

WheelSpeeds WheelLoop::control(const WheelSpeeds& target) CARGOBAY_NONBLOCKING {
  const double tick_s = parameters_.estimator.tick_s;
  const WheelSpeeds set = slew_.step(target, tick_s);
  part_ = reachable_part(set, target);
  given_ = {part_ * set.left_mm_s, part_ * set.right_mm_s};
  limited_ = {.speed = part_ < 1.0, .acceleration = set != target};
  // A command acts a dead time and, in the mean, half a tick later.
  const SlewLimiter later =
      slew_.ahead(target, estimator_.plant().dead_time_s + kActsLaterTicks * tick_s, tick_s);
  const WheelSpeeds now = estimate();
  const WheelSpeeds kept = course_.step(target, given_, now, estimator_.ways(), known(), tick_s);
  const WheelSpeeds disturbance = estimator_.disturbances();
  const PlantEstimate& plant = estimator_.plant();
  VelocityController::Wheel left{.gain = plant.gain_left,
                                 .gain_sd = plant.weakened ? 0.0 : plant.gain_left_sd,
                                 .lag_s = std::max(0.0, plant.lag_s - plant.lag_sd_s),
                                 .proportional = proportional(),
                                 .disturbance_mm_s = disturbance.left_mm_s,
                                 .speed_mm_s = now.left_mm_s};
  VelocityController::Wheel right = left;
  right.gain = plant.gain_right;
  right.gain_sd = plant.weakened ? 0.0 : plant.gain_right_sd;
  right.disturbance_mm_s = disturbance.right_mm_s;
  right.speed_mm_s = now.right_mm_s;
  const bool open = parameters_.feedback == Feedback::open;
  const auto wish = [&](double WheelSpeeds::* wheel) CARGOBAY_NONBLOCKING {
    const double off_mm_s = open ? 0.0 : kept.*wheel - given_.*wheel;
    return VelocityController::Wish{.asked_mm_s = given_.*wheel,
                                    .set_mm_s = given_.*wheel + off_mm_s,
                                    .ahead_mm_s = part_ * later.speeds().*wheel + off_mm_s,
                                    .rate_mm_s2 = part_ * later.rates().*wheel,
                                    .target_mm_s = target.*wheel};
  };
  command_ = {answer(wish(&WheelSpeeds::left_mm_s), left),
              answer(wish(&WheelSpeeds::right_mm_s), right)};
  return command_;
}

void WheelLoop::stop() CARGOBAY_NONBLOCKING {
  command_ = {};
  part_ = 1.0;
  given_ = {};
  limited_ = {};
  slew_.reset({});
  estimator_.doubt_command();
}

Axes WheelLoop::next_reads() CARGOBAY_NONBLOCKING {
  using Motion = ReadSchedule::Motion;
  const bool moving =
      std::abs(command_.left_mm_s) > kMoving || std::abs(command_.right_mm_s) > kMoving;
  const bool changing = slew_.rates() != WheelSpeeds{} || estimator_.load_in_doubt();
  // A robot that still rolls must not be read tick by tick unless it carries the remainder.
  const bool rolls = !moving && !estimator_.rests();
  const double driven_mm_s = (std::abs(command_.left_mm_s) + std::abs(command_.right_mm_s)) / 2.0;
  return schedule_.next_reads({.belief = belief(),
                               .sure = estimator_.sure(),
                               .motion = !moving && !rolls   ? Motion::none
                                         : suspects()        ? Motion::doubtful
                                         : changing || rolls ? Motion::changing
                                                             : Motion::steady,
                               .distance = estimator_.unread_distance(),
                               .turn = estimator_.unread_turn(),
                               .driven_mm = parameters_.estimator.tick_s * driven_mm_s});
}

}  // namespace cargobay::rt
