#include "rt/read_schedule.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::rt {
namespace {

constexpr int kMostTurnTicks = 100'000;
constexpr double kShowsSteps = 0.25;  // a tick: less says nothing about the kind
constexpr double kManySteps = 30.0;
// On the spot, where no distance would show that it stands: after so long, if there are so many.
constexpr double kSomeSteps = 6.0;
constexpr int kSomeTicks = 26;
constexpr int kDoubtfulWindowTicks = 24;  // the longest, of both, while counters are in doubt
constexpr double kGatheredSteps = 1.5;    // then the direction is known, and what a reading loses

bool shows(const WheelEstimator::Unread& axis) CARGOBAY_NONBLOCKING {
  return std::abs(axis.steps_a_tick) >= kShowsSteps;
}

}  // namespace

void ReadSchedule::begin(Phase phase) CARGOBAY_NONBLOCKING {
  phase_ = phase;
  in_phase_ = 0;
}

// A window, successive readings, and so on in turn. An axis in which the robot hardly moves would
// only lose.
Axes ReadSchedule::probe(const Now& now) CARGOBAY_NONBLOCKING {
  if (phase_ == Phase::reads && in_phase_ >= parameters_.probe_reads) begin(Phase::window);
  ++in_phase_;
  const bool turns = shows(now.turn);
  const bool goes = shows(now.distance);
  if (phase_ == Phase::reads && now.belief == RemainderBelief::carried) return kBothAxes;
  if (phase_ == Phase::reads) return {.distance = goes || !turns, .turn = turns};
  if (in_phase_ < parameters_.probe_window_ticks) return {};
  begin(Phase::reads);
  return {.distance = true, .turn = turns || turn_pays(now)};
}

bool ReadSchedule::window(int ticks) CARGOBAY_NONBLOCKING {
  if (++in_phase_ < ticks) return false;
  in_phase_ = 0;
  return true;
}

bool ReadSchedule::turn_pays(const Now& now) const CARGOBAY_NONBLOCKING {
  const WheelEstimator::Unread& turn = now.turn;
  if (since_turn_ < parameters_.least_turn_ticks) return false;
  const double gathered = std::abs(turn.steps);
  // What is known may be wrong, and so much costs little.
  if (gathered >= kManySteps) return true;
  if (!shows(now.distance) && gathered >= kSomeSteps && since_turn_ >= kSomeTicks) return true;
  if (gathered >= kGatheredSteps)
    return turn.sd >= parameters_.turn_sd || since_turn_ >= parameters_.rest_ticks;
  if (turn.sd >= parameters_.most_turn_sd) return true;
  return turn.sd >= parameters_.idle_turn_sd && since_turn_ >= 2 * turn.blank_ticks;
}

bool ReadSchedule::check_due(const Now& now) CARGOBAY_NONBLOCKING {
  ++since_check_;
  if (check_ends_ == 0) {
    const int due = !now.sure                                ? parameters_.recheck_unsure_ticks
                    : now.belief == RemainderBelief::carried ? parameters_.recheck_carried_ticks
                                                             : parameters_.recheck_lost_ticks;
    if (since_check_ < due) return false;
    begin(Phase::window);
    check_ends_ = since_check_ + parameters_.probe_reads + 2 * parameters_.probe_window_ticks;
  }
  if (since_check_ < check_ends_) return true;
  since_check_ = 0;
  check_ends_ = 0;
  return false;
}

// A robot that carries the remainder has nothing to lose: it starts the next motion with fresh
// counters. Neither has another once it has stood for a while; before that, the next motion may
// make a whole step of what is left.
Axes ReadSchedule::rest(const Now& now) CARGOBAY_NONBLOCKING {
  begin(Phase::window);
  moving_ = 0;
  check_ends_ = 0;
  resting_ = std::min(resting_ + 1, parameters_.rest_ticks);
  if (now.belief != RemainderBelief::lost || resting_ == parameters_.rest_ticks) return kBothAxes;
  return {.distance = true, .turn = turn_pays(now)};
}

// First soon, for wheels that stand, as long as it takes a wheel to make two degrees beside another
// that stands; then exactly, for those that count less than they should. What happened before is
// read at once, to be left out of it.
Axes ReadSchedule::doubt(const Now& now) CARGOBAY_NONBLOCKING {
  constexpr double kDegreesMm = 9.0;  // the arc of 2 degrees
  constexpr double kLeastMm = 0.1;
  doubtful_ = std::min(doubtful_ + 1, 4 * kDoubtfulWindowTicks);
  const int shows_ticks =
      !now.sure ? 0 : static_cast<int>(kDegreesMm / std::max(now.driven_mm, kLeastMm));
  const int ticks = std::clamp(std::max(doubtful_ / 4, shows_ticks), parameters_.least_window_ticks,
                               kDoubtfulWindowTicks);
  const bool due = window(ticks) || doubtful_ == 1;
  if (due) in_phase_ = 0;
  return {.distance = due, .turn = due};
}

Axes ReadSchedule::next_reads(const Now& now) CARGOBAY_NONBLOCKING {
  const Axes reads = choose(now);
  since_turn_ = reads.turn ? 0 : std::min(since_turn_ + 1, kMostTurnTicks);
  return reads;
}

Axes ReadSchedule::choose(const Now& now) CARGOBAY_NONBLOCKING {
  steady_ = now.motion == Motion::steady ? std::min(steady_ + 1, 2 * parameters_.window_ticks) : 0;
  if (now.motion == Motion::none) return rest(now);
  resting_ = 0;
  moving_ = std::min(moving_ + 1, parameters_.probe_most_ticks);
  if (now.motion == Motion::doubtful) return doubt(now);
  doubtful_ = 0;
  // At some speeds the kind does not show; long windows serve both.
  if (now.belief == RemainderBelief::unknown && moving_ < parameters_.probe_most_ticks) {
    const bool probes =
        steady_ >= parameters_.probe_steady_ticks || moving_ >= parameters_.probe_moving_ticks;
    if (probes) return probe(now);
    const bool due = window(parameters_.begin_window_ticks);
    return {.distance = due, .turn = due && (shows(now.turn) || turn_pays(now))};
  }
  if (check_due(now)) return probe(now);
  if (now.belief == RemainderBelief::carried) return kBothAxes;
  // A window is half as long as the speed has been steady, within its limits.
  const bool due =
      window(std::clamp(steady_ / 2, parameters_.least_window_ticks, parameters_.window_ticks));
  // Both in one frame, so that the ways of the wheels are known at that time; but while the plant
  // is being learnt, the angle cannot wait.
  const bool turn_may = due || moving_ < parameters_.probe_most_ticks;
  return {.distance = due, .turn = turn_may && turn_pays(now)};
}

}  // namespace cargobay::rt
