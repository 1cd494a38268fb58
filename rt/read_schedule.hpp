// Which frames read which counter.
//
// A robot that carries the remainder is read every tick, the finest possible. One that loses it is
// read as rarely as the loop can bear, since each reading costs up to a step, and each axis when it
// pays: what was not read yet is not lost. The distance, in windows of many ticks. The angle, whose
// steps are 4.5 times as coarse, only once its reading tells much more than it costs. While the
// kind is not known, a moving robot is read both ways in turn, because the contrast shows the kind.
// The finding is rechecked now and then, for it may have been bad luck.
#pragma once

#include "rt/axes.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_estimator.hpp"

namespace cargobay::rt {

class ReadSchedule {
 public:
  struct Parameters {
    int window_ticks = 12;       // between readings of a robot that loses the remainder
    int least_window_ticks = 6;  // the same right after a change of speed: first see, then refine
    int begin_window_ticks = 4;  // as a motion begins and the kind is not known: how do they begin?
    // To find the kind: a window, successive readings, a window, and so on, ...
    int probe_window_ticks = 8;
    int probe_reads = 8;
    // ... once the speed has been steady or the robot has moved for so long.
    int probe_steady_ticks = 10;
    int probe_moving_ticks = 20;
    int probe_most_ticks = 200;       // of motion: from then on only as rechecks
    int recheck_unsure_ticks = 60;    // between rechecks of a kind that little speaks for
    int recheck_carried_ticks = 200;  // between rechecks of the kind: a window costs little
    int recheck_lost_ticks = 1000;    // and a series of readings costs more
    // The angle of a robot that loses the remainder is read once its standard deviation is this
    // many steps: fewer if some steps have gathered, since then a reading costs less. Where few
    // have, and the last reading said 0, it takes twice as long as that one took, or more steps: a
    // robot that hardly turns would lose all of it.
    double turn_sd = 0.7;
    double idle_turn_sd = 1.0;
    double most_turn_sd = 4.0;
    int least_turn_ticks = 10;  // between such readings
    int rest_ticks = 133;       // of standing, after which all is read
  };

  explicit ReadSchedule(const Parameters& parameters) : parameters_{parameters} {}

  // What the wheels do: none is asked to move and they rest, or they are asked for changing speeds,
  // or still roll, or their load seems to change, or they are asked for the same speeds as before.
  enum class Motion {
    none,
    changing,
    steady,
    doubtful,  // counters that may be wrong: windows of both show it
  };

  struct Now {
    RemainderBelief belief = RemainderBelief::unknown;
    bool sure = false;  // much speaks for that
    Motion motion = Motion::none;
    WheelEstimator::Unread distance{};
    WheelEstimator::Unread turn{};
    double driven_mm = 0.0;  // by which wheels of gain 1 move in a tick, whichever way
  };

  // Call once a tick. What the frame of the next tick should read.
  Axes next_reads(const Now& now) CARGOBAY_NONBLOCKING;

 private:
  enum class Phase { reads, window };
  Axes choose(const Now& now) CARGOBAY_NONBLOCKING;
  void begin(Phase phase) CARGOBAY_NONBLOCKING;
  bool check_due(const Now& now) CARGOBAY_NONBLOCKING;
  Axes probe(const Now& now) CARGOBAY_NONBLOCKING;
  Axes rest(const Now& now) CARGOBAY_NONBLOCKING;
  Axes doubt(const Now& now) CARGOBAY_NONBLOCKING;
  bool window(int ticks) CARGOBAY_NONBLOCKING;
  bool turn_pays(const Now& now) const CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  Phase phase_ = Phase::window;
  int in_phase_ = 0;     // ticks
  int since_check_ = 0;  // ticks of motion since the last check of the kind ended
  int check_ends_ = 0;   // in since_check_; 0: none is going on
  int moving_ = 0;       // ticks
  int resting_ = 0;      // ticks, up to rest_ticks
  int steady_ = 0;       // ticks, up to twice window_ticks
  int doubtful_ = 0;     // ticks of motion in doubt, until one is not; stops do not count
  int since_turn_ = 0;   // ticks since the angle was last asked for
};

}  // namespace cargobay::rt
