#include "rt/read_schedule.hpp"

#include <algorithm>

namespace cargobay::rt {

void ReadSchedule::begin(Phase phase) CARGOBAY_NONBLOCKING {
  phase_ = phase;
  in_phase_ = 0;
}

// Reads every frame for a while, then lets one window pass, and starts over.
bool ReadSchedule::probe() CARGOBAY_NONBLOCKING {
  if (phase_ == Phase::reads && in_phase_ >= parameters_.probe_reads) begin(Phase::window);
  ++in_phase_;
  if (phase_ == Phase::reads) return true;
  if (in_phase_ < parameters_.probe_window_ticks) return false;
  begin(Phase::reads);
  return true;
}

// A window is as long as the speed has been steady, within its limits.
bool ReadSchedule::windowed() CARGOBAY_NONBLOCKING {
  const int window = std::clamp(steady_, parameters_.least_window_ticks, parameters_.window_ticks);
  if (++in_phase_ < window) return false;
  in_phase_ = 0;
  return true;
}

bool ReadSchedule::next_reads(RemainderBelief belief, Motion motion) CARGOBAY_NONBLOCKING {
  steady_ = motion == Motion::steady ? std::min(steady_ + 1, parameters_.window_ticks) : 0;
  if (motion == Motion::none) {  // nothing to lose: start the next motion with fresh counters
    begin(Phase::reads);
    since_check_ = 0;
    return true;
  }
  ++since_check_;
  if (belief == RemainderBelief::unknown) return probe();
  const bool carried = belief == RemainderBelief::carried;
  const int quiet_ticks =
      carried ? parameters_.recheck_carried_ticks : parameters_.recheck_lost_ticks;
  if (since_check_ < quiet_ticks) return carried || windowed();
  if (since_check_ == quiet_ticks) begin(Phase::reads);
  if (since_check_ >= quiet_ticks + parameters_.probe_reads + parameters_.probe_window_ticks) {
    since_check_ = 0;
  }
  return probe();
}

}  // namespace cargobay::rt
