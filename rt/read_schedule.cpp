#include "rt/read_schedule.hpp"

#include <algorithm>

namespace cargobay::rt {

void ReadSchedule::begin(Phase phase) CARGOBAY_NONBLOCKING {
  phase_ = phase;
  in_phase_ = 0;
}

// A window, successive readings, and so on in turn.
bool ReadSchedule::probe() CARGOBAY_NONBLOCKING {
  if (phase_ == Phase::reads && in_phase_ >= parameters_.probe_reads) begin(Phase::window);
  ++in_phase_;
  if (phase_ == Phase::reads) return true;
  if (in_phase_ < parameters_.probe_window_ticks) return false;
  begin(Phase::reads);
  return true;
}

bool ReadSchedule::window(int ticks) CARGOBAY_NONBLOCKING {
  if (++in_phase_ < ticks) return false;
  in_phase_ = 0;
  return true;
}

// A window is half as long as the speed has been steady, within its limits.
bool ReadSchedule::windowed() CARGOBAY_NONBLOCKING {
  return window(std::clamp(steady_ / 2, parameters_.least_window_ticks, parameters_.window_ticks));
}

bool ReadSchedule::check_due(RemainderBelief belief, bool sure) CARGOBAY_NONBLOCKING {
  ++since_check_;
  if (check_ends_ == 0) {
    const int due = !sure                                ? parameters_.recheck_unsure_ticks
                    : belief == RemainderBelief::carried ? parameters_.recheck_carried_ticks
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

bool ReadSchedule::next_reads(RemainderBelief belief, bool sure, Motion motion)
    CARGOBAY_NONBLOCKING {
  steady_ = motion == Motion::steady ? std::min(steady_ + 1, 2 * parameters_.window_ticks) : 0;
  if (motion == Motion::none) {  // nothing to lose: start the next motion with fresh counters
    begin(Phase::window);
    moving_ = 0;
    check_ends_ = 0;
    return true;
  }
  moving_ = std::min(moving_ + 1, parameters_.probe_most_ticks);
  // At some speeds the kind does not show; long windows serve both.
  if (belief == RemainderBelief::unknown && moving_ < parameters_.probe_most_ticks) {
    const bool probes =
        steady_ >= parameters_.probe_steady_ticks || moving_ >= parameters_.probe_moving_ticks;
    return probes ? probe() : window(parameters_.probe_window_ticks);
  }
  if (check_due(belief, sure)) return probe();
  return belief == RemainderBelief::carried || windowed();
}

}  // namespace cargobay::rt
