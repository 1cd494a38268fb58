#include "rt/wheel_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cargobay::rt {
namespace {

// The slowest and the quickest plant of the family.
constexpr double kSlowLagS = 0.500;
constexpr double kSlowDeadTimeS = 0.075;
constexpr double kSlowRampMmS2 = 250.0;
constexpr double kQuickLagS = 0.020;
constexpr double kAnyChange = 1e6;      // mm/s: no ramp
constexpr double kHalfStepMmS = 14.25;  // half of the coarsest step of commands, and any dead band

constexpr std::size_t kSlow = 0;
constexpr std::size_t kQuick = 1;
constexpr std::size_t kLikely = 2;

// How fast the sums fade while the wheel is driven.
constexpr double kBriefS = 0.25;
constexpr double kLastingS = 1.2;
// What they must hold before anything is concluded.
constexpr double kLeastBriefS = 0.15;
constexpr double kLeastBriefMm = 5.0;  // of the least way
constexpr double kLeastReversedMm = 8.0;
constexpr double kLeastLastingS = 0.75;
constexpr double kLeastLastingMm = 40.0;  // of the likely way
constexpr double kDrivenMmS = 15.0;       // slower, a wheel may stand within its dead band

// Parts of the least way of a wheel with a gain of 1. The weakest healthy wheel has a gain of 0.6,
// and of 0.45 under a load of 25 %.
constexpr double kStill = 0.30;
constexpr double kLittle = 0.45;
constexpr double kReversed = -0.15;
constexpr double kStillBeside = 0.22;  // of the other wheel's, for its command
// Wheels of one make differ by up to 20 %, and a load of 25 % on the better one leaves 0.72 on the
// default plant; one that counts half has 0.41 to 0.61 of the other's gain.
constexpr double kFewer = 0.69;
constexpr double kUnlike = 0.80;  // the same, if coarse steps act as badly as they can

// What the readings at both ends may have left out, for a wheel, unless each loses it. The half of
// a turn's step is 2.25 mm, but not all of it is wrong as a rule.
constexpr double kEndsMm = 2.0;
constexpr double kEndsLastingMm = 2.5;
constexpr double kDoubt = 0.7;  // of what lost remainders may hide, where much is missing

// Tick by tick, a robot that loses the remainder may read 0 for ever; only a window shows that it
// stands still.
constexpr int kWindowTicks = 4;     // from so many on
constexpr int kLackingWindows = 2;  // the first may be one of before and after
constexpr double kSuspect = 0.42;   // as kStill
constexpr double kLeastSuspectMm = 3.0;
constexpr double kSuddenly = 0.6;  // of what the wheel has counted so far

constexpr double kJumpFadesS = 5.0;
constexpr double kMostJumps = 2.5;
constexpr double kGoesOn = 0.45;  // of a jump, for each further reading of the same one

}  // namespace

// The way of a wheel, as counted.
struct WheelWatch::Counted {
  double mm;
  double doubt_mm;
};

void WheelWatch::Sums::fade(double keep) CARGOBAY_NONBLOCKING {
  counted_mm *= keep;
  doubt_mm *= keep;
  least_mm *= keep;
  most_mm *= keep;
  likely_mm *= keep;
  slow_mm *= keep;
  step_mm *= keep;
  unlike_mm *= keep;
  seconds *= keep;
}

// At most, forward.
double WheelWatch::Sums::most_counted_mm(double ends_mm) const CARGOBAY_NONBLOCKING {
  return counted_mm + kDoubt * doubt_mm + ends_mm;
}

// What happened fades evenly in the time of `more` too.
void WheelWatch::Sums::add(const Sums& more, double fades_s) CARGOBAY_NONBLOCKING {
  const double times = more.seconds / fades_s;
  const double kept = std::exp(-times);
  const double share = times > 0.0 ? (1.0 - kept) / times : 1.0;
  fade(kept);
  counted_mm += share * more.counted_mm;
  doubt_mm += share * more.doubt_mm;
  least_mm += share * more.least_mm;
  most_mm += share * more.most_mm;
  likely_mm += share * more.likely_mm;
  slow_mm += share * more.slow_mm;
  step_mm += share * more.step_mm;
  unlike_mm += share * more.unlike_mm;
  seconds += share * more.seconds;
}

WheelWatch::WheelWatch(const Parameters& parameters) : parameters_{parameters} {
  const double tick_s = parameters.tick_s;
  plants_[kSlow] = {.delay_ticks = (parameters.input_delay_s + kSlowDeadTimeS) / tick_s,
                    .most_mm_s = kSlowRampMmS2 * tick_s,
                    .decay = std::exp(-tick_s / kSlowLagS),
                    .lag_s = kSlowLagS};
  plants_[kQuick] = {.delay_ticks = parameters.input_delay_s / tick_s,
                     .most_mm_s = kAnyChange,
                     .decay = std::exp(-tick_s / kQuickLagS),
                     .lag_s = kQuickLagS};
}

void WheelWatch::step(const WheelSpeeds& command, const PlantEstimate& plant) CARGOBAY_NONBLOCKING {
  now_ = (now_ + 1) % kHistory;
  commands_[now_] = {command.left_mm_s, command.right_mm_s};
  const double tick_s = parameters_.tick_s;
  const double lag_s = std::max(plant.lag_s, kQuickLagS);
  plants_[kLikely] = {.delay_ticks = (parameters_.input_delay_s + plant.dead_time_s) / tick_s,
                      .most_mm_s = plant.ramp_s2_mm > 0.0 ? tick_s / plant.ramp_s2_mm : kAnyChange,
                      .decay = std::exp(-tick_s / lag_s),
                      .lag_s = lag_s};
  for (std::size_t which = 0; which < wheels_.size(); ++which) advance(wheels_[which], which);
  ++ticks_;
  jumps_ *= 1.0 - std::min(1.0, tick_s / kJumpFadesS);
}

// What acts now, so many ticks after it was sent.
double WheelWatch::command_of(std::size_t which, double delay_ticks) const CARGOBAY_NONBLOCKING {
  const double delay = std::min(delay_ticks, static_cast<double>(kHistory - 2));
  const auto whole = static_cast<std::size_t>(delay);
  const double part = delay - static_cast<double>(whole);
  const std::size_t newer = now_ + kHistory - whole;
  return part * commands_[(newer - 1) % kHistory][which] +
         (1.0 - part) * commands_[newer % kHistory][which];
}

// One tick of a wheel in each plant.
void WheelWatch::advance(Wheel& wheel, std::size_t which) CARGOBAY_NONBLOCKING {
  const double tick_s = parameters_.tick_s;
  for (std::size_t i = 0; i < kPlants; ++i) {
    const Plant& plant = plants_[i];
    Model& model = wheel.models[i];
    double command = command_of(which, plant.delay_ticks);
    // The slowest wheel is also the one whose commands act least.
    if (i == kSlow)
      command = std::copysign(std::max(0.0, std::abs(command) - kHalfStepMmS), command);
    model.ramped_mm_s += std::clamp(command - model.ramped_mm_s, -plant.most_mm_s, plant.most_mm_s);
    const double excess = model.speed_mm_s - model.ramped_mm_s;
    model.speed_mm_s = model.ramped_mm_s + plant.decay * excess;
    model.way_mm += plant.lag_s * (1.0 - plant.decay) * excess + tick_s * model.ramped_mm_s;
  }
  const double likely_mm_s = wheel.models[kLikely].speed_mm_s;
  const double newest = commands_[now_][which];
  const double direction = newest == 0.0 ? likely_mm_s : newest;
  for (const Model& model : wheel.models) {
    if (model.speed_mm_s * direction < 0.0) wheel.turns_around = true;
  }
  constexpr double kTurnsMmS = 1.0;
  if (std::abs(likely_mm_s) > kTurnsMmS) wheel.step_mm += kHalfStepMmS * tick_s;
}

// How far a healthy wheel has gone since both counters were read, and how far it was counted.
WheelWatch::Sums WheelWatch::since_reading(const Wheel& wheel, const Counted& counted,
                                           int ticks) const CARGOBAY_NONBLOCKING {
  const double sign = wheel.models[kLikely].way_mm < 0.0 ? -1.0 : 1.0;
  const double likely_mm = std::abs(wheel.models[kLikely].way_mm);
  const double slow_mm = sign * wheel.models[kSlow].way_mm;
  const double quick_mm = sign * wheel.models[kQuick].way_mm;
  const double step_mm = wheel.step_mm;
  const double least_mm = std::min(slow_mm, std::min(quick_mm, likely_mm) - step_mm);
  const double most_mm = std::max({slow_mm + step_mm, quick_mm, likely_mm}) + step_mm;
  return {.counted_mm = sign * counted.mm,
          .doubt_mm = counted.doubt_mm,
          .least_mm = std::max(0.0, least_mm),
          .most_mm = most_mm,
          .likely_mm = likely_mm,
          .slow_mm = slow_mm,
          .step_mm = step_mm,
          .unlike_mm = 0.5 * std::max(0.0, most_mm - least_mm - 2.0 * step_mm),
          .seconds = ticks * parameters_.tick_s};
}

// Adds the time since both counters were read to the sums.
void WheelWatch::take(Wheel& wheel, const Counted& counted, int ticks) CARGOBAY_NONBLOCKING {
  wheel.suspect = false;
  if (wheel.turns_around) {  // what its counter does then is not known
    wheel.brief = {};
    wheel.lasting = {};
    wheel.lacking = 0;
    return;
  }
  const Sums now = since_reading(wheel, counted, ticks);
  if (now.most_mm < kDrivenMmS * now.seconds) return;
  const double most_mm = now.counted_mm + kDoubt * now.doubt_mm;
  const Sums& before = wheel.lasting;
  const bool suddenly = before.likely_mm > kLeastLastingMm &&
                        most_mm * before.likely_mm < kSuddenly * before.counted_mm * now.likely_mm;
  wheel.brief.add(now, kBriefS);
  wheel.lasting.add(now, kLastingS);
  if (ticks >= kWindowTicks) {
    const bool back = now.most_counted_mm(ends_ * kEndsLastingMm) < kReversed * now.least_mm;
    const bool lacks = most_mm < kStill * now.least_mm;
    wheel.lacking = lacks && !back ? std::min(wheel.lacking + 1, kLackingWindows) : 0;
    wheel.suspect = suddenly || lacks;
  } else {
    constexpr double kEndMm = 1.0;
    const Sums& brief = wheel.brief;
    wheel.suspect = brief.least_mm > kLeastSuspectMm &&
                    brief.most_counted_mm(kEndMm) < kSuspect * brief.least_mm;
  }
}

// Both counters start from 0 now.
void WheelWatch::begin() CARGOBAY_NONBLOCKING {
  for (Wheel& wheel : wheels_) {
    for (Model& model : wheel.models) model.way_mm = 0.0;
    wheel.step_mm = 0.0;
    wheel.turns_around = false;
  }
  distance_ = {};
  turn_ = {};
  ticks_ = 0;
}

void WheelWatch::read_unseen(const Axes& axes) CARGOBAY_NONBLOCKING {
  if (axes.both()) return begin();
  distance_.known = distance_.known && !axes.distance;
  turn_.known = turn_.known && !axes.turn;
}

void WheelWatch::read_impossible(const Axes& axes) CARGOBAY_NONBLOCKING {
  read_unseen(axes);
  jumps_ += std::exchange(jumped_, true) ? kGoesOn : 1.0;
  if (jumps_ > kMostJumps && evidence_.what == Finding::nothing) {
    evidence_ = {.what = Finding::jumps, .wheels = {.left = true, .right = true}};
  }
}

// Where the remainder is carried, errors of successive readings cancel out, but for those at the
// ends; where it is lost, each reading falls short by half a step, give or take the other half.
void WheelWatch::Counter::add(int count, int ticks, RemainderBelief remainder, double least_doubt)
    CARGOBAY_NONBLOCKING {
  const bool carried = remainder == RemainderBelief::carried;
  // Tick by tick, the kinds differ by more than there is to see.
  if (!carried && ticks < kWindowTicks) known = false;
  const double lost = carried ? 0.0 : remainder == RemainderBelief::lost ? 0.5 : 0.25;
  steps += count == 0 ? 0.0 : count + (count > 0 ? lost : -lost);
  doubt += carried ? 0.0 : least_doubt;
}

void WheelWatch::read(const Reading& reading, RemainderBelief remainder) CARGOBAY_NONBLOCKING {
  jumped_ = false;
  ends_ = remainder == RemainderBelief::lost ? 0.0 : 1.0;
  constexpr double kDoubtSteps = 0.3;
  constexpr double kBlankSteps = 0.4;  // an angle of 0
  if (reading.distance_mm)
    distance_.add(*reading.distance_mm, reading.distance_ticks, remainder, kDoubtSteps);
  if (reading.angle_deg) {
    turn_.add(*reading.angle_deg, reading.turn_ticks, remainder,
              *reading.angle_deg == 0 ? kBlankSteps : kDoubtSteps);
  }
  if (!reading.axes().both()) return;
  if (distance_.known && turn_.known) compare();
  begin();
}

void WheelWatch::compare() CARGOBAY_NONBLOCKING {
  const double half_step_mm = 0.5 * parameters_.wheel_base_mm * std::numbers::pi / 180.0;
  const double half_turn_mm = half_step_mm * turn_.steps;
  const double doubt_mm = distance_.doubt + half_step_mm * turn_.doubt;
  take(wheels_[0], {distance_.steps - half_turn_mm, doubt_mm}, ticks_);
  take(wheels_[1], {distance_.steps + half_turn_mm, doubt_mm}, ticks_);
  judge();
}

bool WheelWatch::turns_back(const Wheel& wheel) const CARGOBAY_NONBLOCKING {
  const auto back = [this](const Sums& sums, double least_mm) CARGOBAY_NONBLOCKING {
    return sums.least_mm > least_mm &&
           sums.most_counted_mm(ends_ * kEndsMm) < kReversed * sums.least_mm;
  };
  return back(wheel.lasting, kLeastReversedMm) ||
         (wheel.brief.seconds > kLeastBriefS && back(wheel.brief, kLeastBriefMm));
}

bool WheelWatch::still(const Wheel& wheel, const Wheel& other) const CARGOBAY_NONBLOCKING {
  const Sums& sums = wheel.brief;
  if (wheel.lacking < kLackingWindows || sums.seconds < kLeastBriefS) return false;
  const bool by_itself = sums.least_mm > kLeastBriefMm &&
                         sums.most_counted_mm(ends_ * kEndsMm) < kStill * sums.least_mm;
  return by_itself || still_beside(sums, other.brief);
}

// The other wheel turns, and the motors are of one make: then this one is not only slow.
bool WheelWatch::still_beside(const Sums& wheel, const Sums& other) const CARGOBAY_NONBLOCKING {
  constexpr double kLeastMmS = 25.0;
  constexpr double kSameS = 0.02;        // otherwise one of them has turned around
  constexpr double kBeyondLikely = 1.2;  // or is rolling out
  if (wheel.likely_mm < kLeastMmS * wheel.seconds) return false;
  if (std::abs(wheel.seconds - other.seconds) > kSameS) return false;
  if (other.slow_mm <= 0.0 || other.counted_mm > kBeyondLikely * other.likely_mm + 1.0)
    return false;
  const double most_mm = wheel.most_counted_mm(ends_ * kEndsMm);
  const double least_mm = other.counted_mm - kDoubt * other.doubt_mm - ends_ * kEndsMm;
  const double part_mm = kStillBeside * least_mm;
  return least_mm > kLeastBriefMm && most_mm * other.likely_mm < part_mm * wheel.likely_mm &&
         most_mm * other.slow_mm < part_mm * wheel.slow_mm;
}

// Both wheels in the direction in which each is driven: the other axis cancels out, and with it
// what its readings left out.
bool WheelWatch::both_still() const CARGOBAY_NONBLOCKING {
  const Wheel& left = wheels_[0];
  const Wheel& right = wheels_[1];
  if (std::min(left.lacking, right.lacking) < kLackingWindows) return false;
  if (std::min(left.brief.seconds, right.brief.seconds) < kLeastBriefS) return false;
  const bool turns = left.models[kLikely].speed_mm_s * right.models[kLikely].speed_mm_s < 0.0;
  const double ends_mm = ends_ * (turns ? 4.5 : 2.0);
  const double least_mm = left.brief.least_mm + right.brief.least_mm;
  const double most_mm = left.brief.most_counted_mm(ends_mm) + right.brief.counted_mm;
  const auto little = [](const Sums& sums) CARGOBAY_NONBLOCKING {
    return sums.counted_mm < 0.4 * sums.least_mm + 1.0;
  };
  return least_mm > kLeastBriefMm && most_mm < kStill * least_mm && little(left.brief) &&
         little(right.brief);
}

// Less than any unlikeness explains: of the motors, of another plant than the likely one; and less
// than what is left if the steps of commands act against each other as well.
bool WheelWatch::fewer(const Wheel& one, const Wheel& another) const CARGOBAY_NONBLOCKING {
  const Sums& wheel = one.lasting;
  const Sums& other = another.lasting;
  // Not while it still gets less: then it stands, or runs backwards.
  constexpr double kAsBefore = 0.75;
  if (one.brief.counted_mm * wheel.likely_mm < kAsBefore * wheel.counted_mm * one.brief.likely_mm)
    return false;
  if (std::min(wheel.likely_mm, other.likely_mm) < kLeastLastingMm) return false;
  if (std::min(wheel.seconds, other.seconds) < kLeastLastingS) return false;
  const double most_mm = wheel.counted_mm + wheel.doubt_mm + ends_ * kEndsLastingMm;
  const double least_mm = other.counted_mm - other.doubt_mm - ends_ * kEndsLastingMm;
  const auto below = [&](double part, double wheel_mm, double other_mm) CARGOBAY_NONBLOCKING {
    return most_mm * (other.likely_mm + other_mm) < part * least_mm * (wheel.likely_mm - wheel_mm);
  };
  return below(kFewer, wheel.unlike_mm, other.unlike_mm) &&
         below(kUnlike, wheel.unlike_mm + wheel.step_mm, other.unlike_mm + other.step_mm);
}

void WheelWatch::judge() CARGOBAY_NONBLOCKING {
  if (evidence_.what != Finding::nothing) return;
  const Wheel& left = wheels_[0];
  const Wheel& right = wheels_[1];
  const Wheels back{turns_back(left), turns_back(right)};
  if (back.left || back.right) return find(Finding::reversed, back, &Wheel::brief);
  if (both_still()) return find(Finding::still, {true, true}, &Wheel::brief);
  const Wheels stands{still(left, right), still(right, left)};
  if (stands.left || stands.right) {
    const auto little = [this](const Sums& sums) CARGOBAY_NONBLOCKING {
      return sums.most_counted_mm(ends_ * kEndsMm) < kLittle * sums.least_mm;
    };
    const Wheels all{stands.left || little(left.brief), stands.right || little(right.brief)};
    return find(Finding::still, all, &Wheel::brief);
  }
  const Wheels few{fewer(left, right), fewer(right, left)};
  if (few.left || few.right) find(Finding::few, few, &Wheel::lasting);
}

void WheelWatch::find(Finding what, Wheels wheels, Sums Wheel::* sums) CARGOBAY_NONBLOCKING {
  const Sums& left = wheels_[0].*sums;
  const Sums& right = wheels_[1].*sums;
  const auto speed = [](double way_mm, const Sums& of) CARGOBAY_NONBLOCKING {
    return of.seconds > 0.0 ? way_mm / of.seconds : 0.0;
  };
  evidence_ = {.what = what,
               .wheels = wheels,
               .driven = {speed(left.likely_mm, left), speed(right.likely_mm, right)},
               .counted = {speed(left.counted_mm, left), speed(right.counted_mm, right)}};
}

}  // namespace cargobay::rt
