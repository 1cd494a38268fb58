// Which frames read the counters.
//
// A robot that carries the remainder is read every tick, the finest possible. One that loses it is
// read in windows of many ticks, since each reading costs up to a step. While the kind is not
// known, a moving robot is read both ways in turn, because the contrast shows the kind. The finding
// is rechecked now and then, for it may have been bad luck.
#pragma once

#include "rt/nonblocking.hpp"
#include "rt/wheel_estimator.hpp"

namespace cargobay::rt {

class ReadSchedule {
 public:
  struct Parameters {
    int window_ticks = 40;       // between readings of a robot that loses the remainder
    int least_window_ticks = 6;  // the same right after a change of speed: first see, then refine
    // To find the kind: a window, successive readings, a window, and so on, ...
    int probe_window_ticks = 8;
    int probe_reads = 8;
    // ... once the speed has been steady or the robot has moved for so long; until then, windows.
    int probe_steady_ticks = 4;
    int probe_moving_ticks = 20;
    int probe_most_ticks = 200;       // of motion: from then on only as rechecks
    int recheck_unsure_ticks = 60;    // between rechecks of a kind that little speaks for
    int recheck_carried_ticks = 200;  // between rechecks of the kind: a window costs little
    int recheck_lost_ticks = 1000;    // and a series of readings costs more
  };

  explicit ReadSchedule(const Parameters& parameters) : parameters_{parameters} {}

  // What the wheels are asked to do.
  enum class Motion { none, changing, steady };

  // Call once a tick. Whether the frame of the next tick should read the counters. `sure`: much
  // speaks for what is believed.
  bool next_reads(RemainderBelief belief, bool sure, Motion motion) CARGOBAY_NONBLOCKING;

 private:
  enum class Phase { reads, window };
  void begin(Phase phase) CARGOBAY_NONBLOCKING;
  bool check_due(RemainderBelief belief, bool sure) CARGOBAY_NONBLOCKING;
  bool probe() CARGOBAY_NONBLOCKING;
  bool window(int ticks) CARGOBAY_NONBLOCKING;
  bool windowed() CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  Phase phase_ = Phase::window;
  int in_phase_ = 0;     // ticks
  int since_check_ = 0;  // ticks of motion since the last check of the kind ended
  int check_ends_ = 0;   // in since_check_; 0: none is going on
  int moving_ = 0;       // ticks
  int steady_ = 0;       // ticks, up to twice window_ticks
};

}  // namespace cargobay::rt
