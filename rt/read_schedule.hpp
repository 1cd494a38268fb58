// Which frames read the counters.
//
// A robot that carries the remainder is read every tick: the finest there is. One that loses it is
// read in windows of many ticks, since each reading costs up to a step. As long as the kind is not
// known both are done in turn while the robot moves, because the contrast is what tells. What was
// found is tried again now and then, for it may have been found by bad luck.
#pragma once

#include "rt/nonblocking.hpp"
#include "rt/wheel_estimator.hpp"

namespace cargobay::rt {

class ReadSchedule {
 public:
  struct Parameters {
    int window_ticks = 40;        // between readings of a robot that loses the remainder
    int least_window_ticks = 10;  // the same right after a change of speed: first see, then refine
    int probe_window_ticks = 10;  // the same while the kind is not known
    int probe_reads = 12;         // readings in a row while the kind is not known
    int recheck_carried_ticks = 200;  // between trials of what was found: a window costs little
    int recheck_lost_ticks = 1000;    // and a row of readings costs more
  };

  explicit ReadSchedule(const Parameters& parameters) : parameters_{parameters} {}

  // What the wheels are asked to do.
  enum class Motion { none, changing, steady };

  // Once a tick: whether the frame of the next tick shall read the counters.
  bool next_reads(RemainderBelief belief, Motion motion) CARGOBAY_NONBLOCKING;

 private:
  enum class Phase { reads, window };
  void begin(Phase phase) CARGOBAY_NONBLOCKING;
  bool probe() CARGOBAY_NONBLOCKING;
  bool windowed() CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  Phase phase_ = Phase::reads;
  int in_phase_ = 0;     // ticks
  int since_check_ = 0;  // ticks
  int steady_ = 0;       // ticks, up to window_ticks
};

}  // namespace cargobay::rt
