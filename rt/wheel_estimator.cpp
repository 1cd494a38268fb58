#include "rt/wheel_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cargobay::rt {
namespace {

constexpr double kInitialLogOdds = -1.5;  // until proven, the kind that is safe to assume
constexpr double kMostLogOdds = 20.0;     // so that a mistake can still be undone
// A reading that both kinds expected is no evidence. If it counted all the same, the small
// preference that each filter has for its own expectations would add up over a long steady drive
// and decide wrongly.
constexpr double kLeastEvidence = 0.3;
constexpr double kMostSpeed = 600.0;  // mm/s, a fifth above the robot's range
constexpr double kSlackSteps = 2.0;   // of the counter

AxisFilter::Parameters distance_axis(const WheelEstimator::Parameters& parameters) {
  return {.step_mm = 1.0,
          .lag_s = parameters.lag_s,
          .tick_s = parameters.tick_s,
          .speed_noise_mm_s = parameters.speed_noise_mm_s / std::numbers::sqrt2,
          .disturbance_noise_mm_s = 0.3,
          .counter_noise_mm = 0.1};
}

// The turn axis is right minus left, in mm.
AxisFilter::Parameters turn_axis(const WheelEstimator::Parameters& parameters) {
  return {.step_mm = parameters.wheel_base_mm * std::numbers::pi / 180.0,
          .lag_s = parameters.lag_s,
          .tick_s = parameters.tick_s,
          .speed_noise_mm_s = parameters.speed_noise_mm_s * std::numbers::sqrt2,
          .disturbance_noise_mm_s = 0.6,
          .counter_noise_mm = 0.2};
}

// Like std::hypot, for values that neither overflow nor underflow.
double length(double a, double b) CARGOBAY_NONBLOCKING { return std::sqrt(a * a + b * b); }

// How far a wheel's counter may err in one tick: it takes its sign from the command, so a wheel
// that keeps rolling the old way counts the wrong way.
double coasting_error_mm(double command_mm_s, double speed_mm_s, double tick_s)
    CARGOBAY_NONBLOCKING {
  return command_mm_s * speed_mm_s < 0.0 ? 2.0 * std::abs(speed_mm_s) * tick_s : 0.0;
}

}  // namespace

WheelEstimator::WheelEstimator(const Parameters& parameters)
    : parameters_{parameters},
      carried_{Remainder::carried, AxisFilter{distance_axis(parameters)},
               AxisFilter{turn_axis(parameters)}},
      lost_{Remainder::lost, AxisFilter{distance_axis(parameters)},
            AxisFilter{turn_axis(parameters)}} {
  reset();
}

void WheelEstimator::reset() CARGOBAY_NONBLOCKING {
  for (Hypothesis* hypothesis : {&carried_, &lost_}) {
    hypothesis->distance.reset();
    hypothesis->turn.reset();
  }
  carried_likelihood_ = 0.0;
  lost_likelihood_ = 0.0;
  carried_taken_ = {};
  lost_taken_ = {};
  sent_ = {};
  ticks_since_read_ = 0;
  command_unsure_ = 0;
  gone_through_ = 0;
  reading_unsure_ = true;  // the first reading counts from the robot's last read, whenever that was
  set_log_odds(kInitialLogOdds);
  belief_ = RemainderBelief::unknown;
  if (parameters_.remainder.has_value()) {
    const bool is_carried = *parameters_.remainder == Remainder::carried;
    set_log_odds(is_carried ? kMostLogOdds : -kMostLogOdds);
    belief_ = is_carried ? RemainderBelief::carried : RemainderBelief::lost;
  }
}

void WheelEstimator::predict(const WheelSpeeds& command) CARGOBAY_NONBLOCKING {
  const WheelSpeeds now = speeds();
  const double late = std::clamp(parameters_.input_delay_s / parameters_.tick_s, 0.0, 1.0);
  const double left = late * sent_.left_mm_s + (1.0 - late) * command.left_mm_s;
  const double right = late * sent_.right_mm_s + (1.0 - late) * command.right_mm_s;
  const double left_sd = parameters_.droop_sd * (command.left_mm_s - sent_.left_mm_s);
  const double right_sd = parameters_.droop_sd * (command.right_mm_s - sent_.right_mm_s);
  const double change_sd = length(left_sd, right_sd);
  const double astray =
      length(coasting_error_mm(command.left_mm_s, now.left_mm_s, parameters_.tick_s),
             coasting_error_mm(command.right_mm_s, now.right_mm_s, parameters_.tick_s));
  for (Hypothesis* hypothesis : {&carried_, &lost_}) {
    if (left == 0.0 && right == 0.0) {
      hypothesis->distance.coast(change_sd / 2.0, astray / 2.0);
      hypothesis->turn.coast(change_sd, astray);
    } else {
      hypothesis->distance.predict((left + right) / 2.0, change_sd / 2.0, astray / 2.0);
      hypothesis->turn.predict(right - left, change_sd, astray);
    }
  }
  sent_ = command;
  ++ticks_since_read_;
  command_unsure_ = std::max(command_unsure_ - 1, 0);
}

void WheelEstimator::step(const WheelSpeeds& command, const std::optional<Reading>& reading)
    CARGOBAY_NONBLOCKING {
  if (gone_through_ > 0) {
    --gone_through_;
    reading_unsure_ = reading_unsure_ || reading.has_value();
    return;
  }
  predict(command);
  if (!reading.has_value()) return;
  const bool believed = plausible(*reading);
  ticks_since_read_ = 0;
  if (!believed || reading_unsure_) {
    read_unseen();
    return;
  }
  const double carried = carried_.distance.read(reading->distance_mm, Remainder::carried) +
                         carried_.turn.read(reading->angle_deg, Remainder::carried);
  const double lost = lost_.distance.read(reading->distance_mm, Remainder::lost) +
                      lost_.turn.read(reading->angle_deg, Remainder::lost);
  carried_likelihood_ += carried;
  lost_likelihood_ += lost;
  if (command_unsure_ == 0) weigh(carried - lost);
}

void WheelEstimator::doubt_command() CARGOBAY_NONBLOCKING {
  constexpr double kLags = 3.0;
  command_unsure_ = static_cast<int>(std::ceil(kLags * parameters_.lag_s / parameters_.tick_s));
}

// Whether a robot at full speed, and then some, could have gone this far since the last reading.
bool WheelEstimator::plausible(const Reading& reading) const CARGOBAY_NONBLOCKING {
  const double most_mm = kMostSpeed * parameters_.tick_s * ticks_since_read_ + kSlackSteps;
  const double most_deg =
      2.0 * most_mm / parameters_.wheel_base_mm * 180.0 / std::numbers::pi + kSlackSteps;
  return std::abs(reading.distance_mm) <= most_mm && std::abs(reading.angle_deg) <= most_deg;
}

void WheelEstimator::read_unseen() CARGOBAY_NONBLOCKING {
  reading_unsure_ = false;
  for (Hypothesis* hypothesis : {&carried_, &lost_}) {
    hypothesis->distance.read_unseen(hypothesis->remainder);
    hypothesis->turn.read_unseen(hypothesis->remainder);
  }
}

void WheelEstimator::step_lost(const WheelSpeeds& command, bool may_have_read)
    CARGOBAY_NONBLOCKING {
  predict(command);
  if (may_have_read) reading_unsure_ = true;
}

void WheelEstimator::weigh(double log_odds) CARGOBAY_NONBLOCKING {
  if (parameters_.remainder.has_value() || std::abs(log_odds) < kLeastEvidence) return;
  set_log_odds(std::clamp(log_odds_ + log_odds, -kMostLogOdds, kMostLogOdds));
  if (log_odds_ >= parameters_.decision_log_odds) belief_ = RemainderBelief::carried;
  if (log_odds_ <= -parameters_.decision_log_odds) belief_ = RemainderBelief::lost;
}

void WheelEstimator::set_log_odds(double log_odds) CARGOBAY_NONBLOCKING {
  log_odds_ = log_odds;
  carried_weight_ = 1.0 / (1.0 + std::exp(-log_odds));
}

WheelSpeeds WheelEstimator::speeds() const CARGOBAY_NONBLOCKING {
  const double weight = carried_weight_;
  const double mean =
      weight * carried_.distance.speed_mm_s() + (1.0 - weight) * lost_.distance.speed_mm_s();
  const double difference =
      weight * carried_.turn.speed_mm_s() + (1.0 - weight) * lost_.turn.speed_mm_s();
  return {mean - difference / 2.0, mean + difference / 2.0};
}

WheelEstimator::Taken WheelEstimator::total(const Hypothesis& hypothesis) CARGOBAY_NONBLOCKING {
  return {.distance_mm = hypothesis.distance.travel_mm(),
          .turn_mm = hypothesis.turn.travel_mm(),
          .distance_variance = hypothesis.distance.forgotten_variance(),
          .turn_variance = hypothesis.turn.forgotten_variance()};
}

// Each step uses what is believed at the time: finding out the kind late does not move the past.
Travel WheelEstimator::take_travel() CARGOBAY_NONBLOCKING {
  const Taken carried = total(carried_);
  const Taken lost = total(lost_);
  const double weight = carried_weight_;
  const auto since = [&](double Taken::* member) CARGOBAY_NONBLOCKING {
    return weight * (carried.*member - carried_taken_.*member) +
           (1.0 - weight) * (lost.*member - lost_taken_.*member);
  };
  const Hypothesis& likely = log_odds_ > 0.0 ? carried_ : lost_;
  const double base = parameters_.wheel_base_mm;
  const Travel travel{.distance_mm = since(&Taken::distance_mm),
                      .turn_rad = since(&Taken::turn_mm) / base,
                      .distance_variance = since(&Taken::distance_variance),
                      .turn_variance = since(&Taken::turn_variance) / (base * base),
                      .unread_distance_variance = likely.distance.unread_variance(),
                      .unread_turn_variance = likely.turn.unread_variance() / (base * base)};
  carried_taken_ = carried;
  lost_taken_ = lost;
  return travel;
}

double WheelEstimator::speed_sd_mm_s() const CARGOBAY_NONBLOCKING {
  const Hypothesis& likely = log_odds_ > 0.0 ? carried_ : lost_;
  return std::sqrt(likely.distance.speed_variance() + likely.turn.speed_variance() / 4.0);
}

}  // namespace cargobay::rt
