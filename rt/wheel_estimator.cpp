#include "rt/wheel_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cargobay::rt {
namespace {

constexpr double kMostLogOdds = 20.0;  // so that a mistake can still be undone
// A reading that both kinds expected is no evidence. If it counted all the same, the small
// preference that each filter has for its own expectations would add up over a long steady drive
// and decide wrongly.
constexpr double kLeastEvidence = 0.3;
// Of what the filters say as long as the kind is not sure: they depend on what is known of the
// plant, so it is little, but it speaks where the counts do not, at whole steps a tick.
constexpr double kShareForCarried = 0.7;
constexpr double kShareForLost = 0.45;     // a plant that answers late looks like it
constexpr double kMostOfFilters = 2.0;     // of one reading
constexpr double kMostOfAllFilters = 6.0;  // enough to decide while the counts are silent
constexpr double kCountsSpeak = 2.5;       // from then on, filters that contradict are not heard
constexpr double kSureLogOdds = 10.0;
constexpr double kMostSpeed = 600.0;  // mm/s, a fifth above the robot's range
constexpr double kSlackSteps = 2.0;   // of the counter

AxisFilter::Parameters distance_axis(const WheelEstimator::Parameters& parameters) {
  return {.step_mm = 1.0,
          .tick_s = parameters.tick_s,
          .speed_noise_mm_s = parameters.speed_noise_mm_s / std::numbers::sqrt2,
          .counter_noise_mm = 0.1};
}

// The turn axis is right minus left, in mm.
AxisFilter::Parameters turn_axis(const WheelEstimator::Parameters& parameters) {
  return {.step_mm = parameters.wheel_base_mm * std::numbers::pi / 180.0,
          .tick_s = parameters.tick_s,
          .speed_noise_mm_s = parameters.speed_noise_mm_s * std::numbers::sqrt2,
          .disturbance_noise_mm_s = 2.0,
          .counter_noise_mm = 0.2};
}

// Like std::hypot, for values that neither overflow nor underflow.
double length(double a, double b) CARGOBAY_NONBLOCKING { return std::sqrt(a * a + b * b); }

double by_filters(double log_odds) CARGOBAY_NONBLOCKING {
  if (std::abs(log_odds) < kLeastEvidence) return 0.0;
  return (log_odds > 0.0 ? kShareForCarried : kShareForLost) *
         std::clamp(log_odds, -kMostOfFilters, kMostOfFilters);
}

// How far a wheel's counter may err in one tick: it takes its sign from the command, so a wheel
// that keeps rolling the old way counts the wrong way.
double coasting_error_mm(double command_mm_s, double speed_mm_s, double tick_s)
    CARGOBAY_NONBLOCKING {
  return command_mm_s * speed_mm_s < 0.0 ? 2.0 * std::abs(speed_mm_s) * tick_s : 0.0;
}

}  // namespace

WheelEstimator::WheelEstimator(const Parameters& parameters)
    : parameters_{parameters},
      carried_{Remainder::carried,
               AxisFilter{distance_axis(parameters)},
               AxisFilter{turn_axis(parameters)},
               {}},
      lost_{Remainder::lost,
            AxisFilter{distance_axis(parameters)},
            AxisFilter{turn_axis(parameters)},
            {}},
      bank_{{.wheel_base_mm = parameters.wheel_base_mm,
             .tick_s = parameters.tick_s,
             .input_delay_s = parameters.input_delay_s,
             .likely_lag_s = parameters.likely_lag_s,
             .told = parameters.told}} {
  reset();
}

void WheelEstimator::reset() CARGOBAY_NONBLOCKING {
  for (Hypothesis* hypothesis : {&carried_, &lost_}) {
    hypothesis->distance.reset();
    hypothesis->turn.reset();
    hypothesis->taken = {};
  }
  carried_likelihood_ = 0.0;
  lost_likelihood_ = 0.0;
  bank_.reset();
  if (parameters_.prior) bank_.begin_from(*parameters_.prior);
  judge_.doubt();
  zeros_ = 0;
  command_unsure_ = 0;
  moved_ticks_ = 0;
  ticks_since_read_ = 0;
  gone_through_ = 0;
  reading_unsure_ = true;  // the first reading counts from the robot's last read, whenever that was
  counts_say_ = 0.0;
  filters_say_ = 0.0;
  set_log_odds(0.0);
  belief_ = RemainderBelief::unknown;
  if (parameters_.remainder.has_value()) {
    const bool is_carried = *parameters_.remainder == Remainder::carried;
    set_log_odds(is_carried ? kMostLogOdds : -kMostLogOdds);
    belief_ = is_carried ? RemainderBelief::carried : RemainderBelief::lost;
  }
}

void WheelEstimator::predict(const WheelSpeeds& command) CARGOBAY_NONBLOCKING {
  const WheelSpeeds now = speeds();
  bank_.step(command);
  if (command != WheelSpeeds{}) ++moved_ticks_;
  command_unsure_ = std::max(command_unsure_ - 1, 0);
  const PlantEstimate& plant = bank_.estimate();
  const WheelSpeeds driven{plant.gain_left * bank_.driven().left_mm_s,
                           plant.gain_right * bank_.driven().right_mm_s};
  const AxisFilter::Response response = AxisFilter::response(plant.lag_s, parameters_.tick_s);
  // A gain that is wrong shows in the speed itself; a lag, while it changes.
  const double gain_sd = plant.gain_sd * length(driven.left_mm_s, driven.right_mm_s);
  const double lag_sd =
      plant.lag_sd_s / plant.lag_s *
      length(driven.left_mm_s - now.left_mm_s, driven.right_mm_s - now.right_mm_s);
  const double speed_sd = response.speed_by_input * length(gain_sd, lag_sd);
  const double astray =
      length(coasting_error_mm(command.left_mm_s, now.left_mm_s, parameters_.tick_s),
             coasting_error_mm(command.right_mm_s, now.right_mm_s, parameters_.tick_s));
  const AxisFilter::Doubt half{speed_sd / 2.0, astray / 2.0};
  const AxisFilter::Doubt whole{speed_sd, astray};
  constexpr double kDriven = 0.1;  // mm/s
  const bool coasts = std::abs(driven.left_mm_s) < kDriven && std::abs(driven.right_mm_s) < kDriven;
  for (Hypothesis* hypothesis : {&carried_, &lost_}) {
    if (coasts) {
      hypothesis->distance.coast(response, half);
      hypothesis->turn.coast(response, whole);
    } else {
      hypothesis->distance.predict((driven.left_mm_s + driven.right_mm_s) / 2.0, response, half);
      hypothesis->turn.predict(driven.right_mm_s - driven.left_mm_s, response, whole);
    }
  }
  ++ticks_since_read_;
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
  const int ticks = ticks_since_read_;
  ticks_since_read_ = 0;
  if (!believed || reading_unsure_) {
    read_unseen();
    return;
  }
  const bool zero = reading->distance_mm == 0 && reading->angle_deg == 0;
  zeros_ = zero ? zeros_ + 1 : 0;
  const double carried = carried_.distance.read(reading->distance_mm, Remainder::carried) +
                         carried_.turn.read(reading->angle_deg, Remainder::carried);
  const double lost = lost_.distance.read(reading->distance_mm, Remainder::lost) +
                      lost_.turn.read(reading->angle_deg, Remainder::lost);
  carried_likelihood_ += carried;
  lost_likelihood_ += lost;
  bank_.read(PlantBank::Axis::distance, reading->distance_mm, ticks, belief_);
  bank_.read(PlantBank::Axis::turn, reading->angle_deg, ticks, belief_);
  const double by_counts = judge_.read(ticks, {reading->distance_mm, reading->angle_deg});
  const bool silent = sure() || command_unsure_ > 0 || bank_.steady();
  weigh(by_counts, silent ? 0.0 : by_filters(carried - lost));
}

void WheelEstimator::doubt_command() CARGOBAY_NONBLOCKING {
  constexpr double kLags = 3.0;
  command_unsure_ =
      static_cast<int>(std::ceil(kLags * bank_.estimate().lag_s / parameters_.tick_s));
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
  judge_.doubt();
  bank_.read_unseen();
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

// The filters may decide for now, but never against the counts.
void WheelEstimator::weigh(double by_counts, double by_filters) CARGOBAY_NONBLOCKING {
  if (parameters_.remainder.has_value() || (by_counts == 0.0 && by_filters == 0.0)) return;
  counts_say_ = std::clamp(counts_say_ + by_counts, -kMostLogOdds, kMostLogOdds);
  filters_say_ = std::clamp(filters_say_ + by_filters, -kMostOfAllFilters, kMostOfAllFilters);
  if (std::abs(counts_say_) >= kCountsSpeak && counts_say_ * filters_say_ < 0.0) filters_say_ = 0.0;
  set_log_odds(counts_say_ + filters_say_);
  if (log_odds_ >= parameters_.decision_log_odds) belief_ = RemainderBelief::carried;
  if (log_odds_ <= -parameters_.decision_log_odds) belief_ = RemainderBelief::lost;
}

void WheelEstimator::set_log_odds(double log_odds) CARGOBAY_NONBLOCKING {
  log_odds_ = log_odds;
  carried_weight_ = 1.0 / (1.0 + std::exp(-log_odds - prior_log_odds()));
}

// Of the kind that the prior names. No evidence: it decides nothing, and a wrong one costs no more
// than not to know.
double WheelEstimator::prior_log_odds() const CARGOBAY_NONBLOCKING {
  constexpr double kPrior = 2.0;
  if (!parameters_.prior || parameters_.remainder) return 0.0;
  switch (parameters_.prior->remainder) {
    case RemainderBelief::carried: return kPrior;
    case RemainderBelief::lost: return -kPrior;
    case RemainderBelief::unknown: break;
  }
  return 0.0;
}

LearntPlant WheelEstimator::learnt() const CARGOBAY_NONBLOCKING {
  LearntPlant learnt = bank_.learnt();
  learnt.remainder = belief_;
  learnt.log_odds_carried = log_odds_;
  learnt.moved_s = static_cast<double>(moved_ticks_) * parameters_.tick_s;
  return learnt;
}

WheelSpeeds WheelEstimator::mix(double (AxisFilter::*value)() const CARGOBAY_NONBLOCKING) const
    CARGOBAY_NONBLOCKING {
  const double weight = carried_weight_;
  const double mean =
      weight * (carried_.distance.*value)() + (1.0 - weight) * (lost_.distance.*value)();
  const double difference =
      weight * (carried_.turn.*value)() + (1.0 - weight) * (lost_.turn.*value)();
  return {mean - difference / 2.0, mean + difference / 2.0};
}

WheelSpeeds WheelEstimator::speeds() const CARGOBAY_NONBLOCKING {
  return mix(&AxisFilter::speed_mm_s);
}

WheelSpeeds WheelEstimator::disturbances() const CARGOBAY_NONBLOCKING {
  return mix(&AxisFilter::disturbance_mm_s);
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

Travels WheelEstimator::take_travels() CARGOBAY_NONBLOCKING {
  return {.if_carried = take_travel(carried_), .if_lost = take_travel(lost_)};
}

bool WheelEstimator::sure() const CARGOBAY_NONBLOCKING {
  return std::abs(log_odds_) >= kSureLogOdds;
}

double WheelEstimator::speed_sd_mm_s() const CARGOBAY_NONBLOCKING {
  const Hypothesis& likely = log_odds_ > 0.0 ? carried_ : lost_;
  return std::sqrt(likely.distance.speed_variance() + likely.turn.speed_variance() / 4.0);
}

}  // namespace cargobay::rt
