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
// The turn of a robot that loses the remainder is foreseen for seconds, so its noise must be true:
// a part of what lets the filter follow readings of every tick, and less where the lag smooths it.
constexpr double kCalm = 0.7;
constexpr double kCalmResponse = 0.139;  // of a lag of 100 ms
constexpr double kOneAxis = 0.7;         // both wheels err alike only in part

AxisFilter::Parameters distance_axis(const WheelEstimator::Parameters& parameters) {
  return {.step_mm = 1.0,
          .tick_s = parameters.tick_s,
          .speed_noise_mm_s = parameters.speed_noise_mm_s / std::numbers::sqrt2,
          .counter_noise_mm = 0.1};
}

// The turn axis is right minus left, in mm.
AxisFilter::Parameters turn_axis(const WheelEstimator::Parameters& parameters, bool lost) {
  return {.step_mm = parameters.wheel_base_mm * std::numbers::pi / 180.0,
          .tick_s = parameters.tick_s,
          .speed_noise_mm_s = lost ? 0.0 : parameters.speed_noise_mm_s * std::numbers::sqrt2,
          .disturbance_noise_mm_s = lost ? 1.5 : 2.0,
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
               AxisFilter{turn_axis(parameters, false)},
               {}},
      lost_{Remainder::lost,
            AxisFilter{distance_axis(parameters)},
            AxisFilter{turn_axis(parameters, true)},
            {}},
      bank_{{.wheel_base_mm = parameters.wheel_base_mm,
             .tick_s = parameters.tick_s,
             .input_delay_s = parameters.input_delay_s,
             .likely_lag_s = parameters.likely_lag_s,
             .told = parameters.told}},
      turns_{{.step_mm = parameters.wheel_base_mm * std::numbers::pi / 180.0,
              .tick_s = parameters.tick_s}} {
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
  turns_.reset(gains());
  taken_turns_ = {};
  corrected_mm_ = 0.0;
  follows_turns_ = true;
  // The first reading counts from the robot's last read, whenever that was.
  distance_ = {.unsure = true};
  turn_ = {.unsure = true};
  command_unsure_ = 0;
  moved_ticks_ = 0;
  gone_through_ = 0;
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
  just_corrected_mm_ = 0.0;
  bank_.step(command);
  if (command != WheelSpeeds{}) ++moved_ticks_;
  command_unsure_ = std::max(command_unsure_ - 1, 0);
  const PlantEstimate& plant = bank_.estimate();
  const WheelSpeeds driven{plant.gain_left * bank_.driven().left_mm_s,
                           plant.gain_right * bank_.driven().right_mm_s};
  const AxisFilter::Response response = AxisFilter::response(plant.lag_s, parameters_.tick_s);
  // A gain that is wrong shows in the speed itself; a lag, while it changes.
  const double mean = (driven.left_mm_s + driven.right_mm_s) / 2.0;
  const double difference = driven.right_mm_s - driven.left_mm_s;
  const double lag_share = plant.lag_sd_s / plant.lag_s;
  const double half_sd =
      kOneAxis *
      length(plant.gain_sd * mean, lag_share * (mean - (now.left_mm_s + now.right_mm_s) / 2.0));
  const double whole_sd =
      kOneAxis * length(plant.gain_sd * difference,
                        lag_share * (difference - (now.right_mm_s - now.left_mm_s)));
  const double astray =
      length(coasting_error_mm(command.left_mm_s, now.left_mm_s, parameters_.tick_s),
             coasting_error_mm(command.right_mm_s, now.right_mm_s, parameters_.tick_s));
  const AxisFilter::Doubt half{response.speed_by_input * half_sd, astray / 2.0};
  const double calm = kCalm * parameters_.speed_noise_mm_s * std::numbers::sqrt2 *
                      std::min(1.0, response.speed_by_input / kCalmResponse);
  const AxisFilter::Doubt whole{response.speed_by_input * whole_sd, astray};
  const AxisFilter::Doubt whole_lost{length(whole.speed_mm_s, calm), astray};
  constexpr double kDriven = 0.1;  // mm/s
  const bool coasts = std::abs(driven.left_mm_s) < kDriven && std::abs(driven.right_mm_s) < kDriven;
  for (Hypothesis* hypothesis : {&carried_, &lost_}) {
    if (coasts) {
      hypothesis->distance.coast(response, half);
      hypothesis->turn.coast(response, hypothesis == &lost_ ? whole_lost : whole);
    } else {
      hypothesis->distance.predict((driven.left_mm_s + driven.right_mm_s) / 2.0, response, half);
      hypothesis->turn.predict(driven.right_mm_s - driven.left_mm_s, response,
                               hypothesis == &lost_ ? whole_lost : whole);
    }
  }
  follow_turn(response, whole);
  ++distance_.ticks;
  ++turn_.ticks;
  turn_.straight_mm +=
      parameters_.tick_s * (bank_.driven().left_mm_s + bank_.driven().right_mm_s) / 2.0;
  if (command != WheelSpeeds{}) {
    distance_.zeros = 0;
    turn_.zeros = 0;
  }
}

void WheelEstimator::step(const WheelSpeeds& command, const Reading& reading) CARGOBAY_NONBLOCKING {
  seen_ = {};
  if (gone_through_ > 0) {
    --gone_through_;
    doubt_next_reading(reading.axes());
    seen_.how = Seen::How::past;
    return;
  }
  predict(command);
  if (!reading.axes().any()) return;
  const bool believed = plausible(reading);
  const bool unsure =
      (reading.distance_mm && distance_.unsure) || (reading.angle_deg && turn_.unsure);
  seen_ = {.how = unsure          ? Seen::How::unsure
                  : !believed     ? Seen::How::impossible
                  : wild(reading) ? Seen::How::wild
                                  : Seen::How::believed,
           .distance_ticks = distance_.ticks,
           .turn_ticks = turn_.ticks,
           .strange =
               !unsure && ((reading.distance_mm && strange(Axis::distance, *reading.distance_mm)) ||
                           (reading.angle_deg && strange(Axis::turn, *reading.angle_deg)))};
  if (!believed) doubt_next_reading(reading.axes());
  Evidence evidence;
  if (reading.distance_mm) evidence = read(Axis::distance, *reading.distance_mm);
  if (reading.angle_deg) {
    const Evidence of_turn = read(Axis::turn, *reading.angle_deg);
    evidence.by_counts += of_turn.by_counts;
    evidence.by_filters += of_turn.by_filters;
  }
  bank_.conclude();
  const bool silent = sure() || command_unsure_ > 0 || bank_.steady();
  weigh(evidence.by_counts, silent ? 0.0 : by_filters(evidence.by_filters));
}

WheelEstimator::Evidence WheelEstimator::read(Axis axis, int count) CARGOBAY_NONBLOCKING {
  const bool turns = axis == Axis::turn;
  Counter& counter = turns ? turn_ : distance_;
  const int ticks = std::exchange(counter.ticks, 0);
  const double straight_mm = std::exchange(counter.straight_mm, 0.0);
  const bool surprises = surprising(axis, count);
  const bool once = surprises && !counter.surprised;
  counter.surprised = once;
  if (std::exchange(counter.unsure, false) || once) {
    read_unseen(axis);
    return {};
  }
  counter.zeros = count == 0 ? counter.zeros + 1 : 0;
  counter.blank_ticks = count == 0 ? ticks : 0;
  if (turns && ticks > 1) {
    const double off_mm = bank_.estimate().gain_difference_sd * straight_mm;
    const double off_mm_s = off_mm / (ticks * parameters_.tick_s);
    carried_.turn.doubt_all_along(off_mm, off_mm_s);
    lost_.turn.doubt_all_along(off_mm, off_mm_s);
  }
  const double carried =
      (turns ? carried_.turn : carried_.distance).read(count, Remainder::carried);
  const double lost = (turns ? lost_.turn : lost_.distance).read(count, Remainder::lost);
  if (turns && follows_turns_) {
    const double former_mm = turns_.turn_mm();
    turns_.read(count);
    just_corrected_mm_ = turns_.turn_mm() - former_mm;
    corrected_mm_ += just_corrected_mm_;
  }
  carried_likelihood_ += carried;
  lost_likelihood_ += lost;
  bank_.read(axis, count, ticks, belief_, speeds());
  const RemainderJudge::Counts counts =
      turns ? RemainderJudge::Counts{.turn = count} : RemainderJudge::Counts{.distance = count};
  return {.by_counts = counter.judge.read(ticks, counts, bank_.steady()),
          .by_filters = turns ? std::max(0.0, carried - lost) : carried - lost};
}

void WheelEstimator::doubt_command() CARGOBAY_NONBLOCKING {
  constexpr double kLags = 3.0;
  command_unsure_ =
      static_cast<int>(std::ceil(kLags * bank_.estimate().lag_s / parameters_.tick_s));
}

void WheelEstimator::read_unseen(Axis axis) CARGOBAY_NONBLOCKING {
  const bool turns = axis == Axis::turn;
  (turns ? turn_ : distance_).judge.doubt();
  bank_.read_unseen(axis);
  if (turns && follows_turns_) turns_.read_unseen();
  for (Hypothesis* hypothesis : {&carried_, &lost_})
    (turns ? hypothesis->turn : hypothesis->distance).read_unseen(hypothesis->remainder);
}

void WheelEstimator::step_lost(const WheelSpeeds& command, const Axes& may_have_read)
    CARGOBAY_NONBLOCKING {
  predict(command);
  doubt_next_reading(may_have_read);
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

WheelEstimator::Unread WheelEstimator::unread_distance() const CARGOBAY_NONBLOCKING {
  const AxisFilter& axis = lost_.distance;
  return {.steps = axis.unread_mm(),
          .sd = std::sqrt(axis.unread_variance()),
          .steps_a_tick = axis.speed_mm_s() * parameters_.tick_s};
}

// Until some motion has shown it, a wheel may also turn as no plant would have it.
WheelEstimator::Unread WheelEstimator::unread_turn() const CARGOBAY_NONBLOCKING {
  constexpr double kShownS = 3.0;
  const AxisFilter& axis = lost_.turn;
  const double step_mm = parameters_.wheel_base_mm * std::numbers::pi / 180.0;
  const bool shown = sure() && static_cast<double>(moved_ticks_) * parameters_.tick_s > kShownS;
  const double off_mm = bank_.estimate().gain_difference_sd * turn_.straight_mm;
  const double sd_mm = shown ? std::sqrt(turns_.unread_variance())
                             : length(std::sqrt(axis.unread_variance()), off_mm);
  return {.steps = (shown ? turns_.unread_mm() : axis.unread_mm()) / step_mm,
          .sd = sd_mm / step_mm,
          .steps_a_tick = axis.speed_mm_s() * parameters_.tick_s / step_mm,
          .blank_ticks = turn_.blank_ticks};
}

bool WheelEstimator::rests() const CARGOBAY_NONBLOCKING {
  constexpr double kKnownSd = 1.2;      // steps
  constexpr double kStillSteps = 0.01;  // a tick
  if (distance_.zeros < 2) return false;
  if (turn_.zeros >= 2) return true;
  const Unread turn = unread_turn();
  return turn.sd < kKnownSd && std::abs(turn.steps_a_tick) < kStillSteps;
}

bool WheelEstimator::sure() const CARGOBAY_NONBLOCKING {
  return std::abs(log_odds_) >= kSureLogOdds;
}

double WheelEstimator::speed_sd_mm_s() const CARGOBAY_NONBLOCKING {
  const Hypothesis& likely = log_odds_ > 0.0 ? carried_ : lost_;
  return std::sqrt(likely.distance.speed_variance() + likely.turn.speed_variance() / 4.0);
}

}  // namespace cargobay::rt
