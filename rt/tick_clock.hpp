// Counts the robot's ticks by the frames that arrive, and tells a late frame from a lost one.
//
// Frames are sent once a tick; they arrive late, in bunches, or not at all, but never early and
// never out of order. The earliest arrivals therefore show the robot's phase, whose drift is
// followed slowly. A frame that is missing when the next one arrives may still be on its way (with
// a USB adapter that hands over every 16 ms, several frames in a row are more than a tick late). It
// counts as lost when something has been missing for six ticks, or for two if more than two frames
// are missing, or as soon as it is known to have been damaged. A frame that was given up but
// arrives within a second is taken back.
#pragma once

#include <cstdint>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class TickClock {
 public:
  // Ticks for which something is missing before it is given up.
  static constexpr int kPatience = 6;
  // Arrivals, in phase, until the phase is known: as many as an adapter that hands over every 16 ms
  // takes from one frame on time to the next.
  static constexpr int kArrivalsToKnow = 16;

  explicit TickClock(Duration tick) : tick_{tick}, early_{tick / kEarlyShare} {}

  // The first frame, or the first after silence: counting starts again from here.
  void start(TimePoint arrival) CARGOBAY_NONBLOCKING;
  bool started() const CARGOBAY_NONBLOCKING { return started_; }

  // `frames` (1 or more) were received together. `damaged`: how many bad frames have been seen;
  // those beyond the number missing do not count. Returns how many frames before these are now
  // known to be lost, the damaged ones included; if negative, how many of `frames` had been given
  // up.
  int arrived(TimePoint arrival, int frames, std::uint64_t damaged = 0) CARGOBAY_NONBLOCKING;

  // When the latest frame due by `time` was due.
  TimePoint due_by(TimePoint time) const CARGOBAY_NONBLOCKING;
  // False after an arrival so early that the phase must have been wrong, and may still be.
  bool in_phase() const CARGOBAY_NONBLOCKING { return in_phase_; }
  // In phase for long enough that one of the frames since then was on time and showed the phase.
  bool knows_phase() const CARGOBAY_NONBLOCKING { return in_phase_for_ == kArrivalsToKnow; }
  // When the next frame arrives if it is on time.
  TimePoint expected() const CARGOBAY_NONBLOCKING { return phase_ + tick_; }
  // Frames received and lost since start().
  std::int64_t ticks() const CARGOBAY_NONBLOCKING { return counted_; }
  // Frames that were due at the last arrival and are late or lost: it is not known yet which.
  std::int64_t missing() const CARGOBAY_NONBLOCKING { return by_time_ - counted_; }
  // So many are missing that the newest frame may belong to any of several ticks: a bunch is still
  // being handed over, or they are lost. The next arrival, in another tick, decides.
  bool in_doubt() const CARGOBAY_NONBLOCKING;

 private:
  std::int64_t settle(std::int64_t passed, std::uint64_t damaged) CARGOBAY_NONBLOCKING;
  std::int64_t take_back(TimePoint arrival) CARGOBAY_NONBLOCKING;

  // An arrival this much early still belongs to that tick: a quarter of a tick.
  static constexpr int kEarlyShare = 4;

  Duration tick_;
  Duration early_;
  bool started_ = false;
  bool in_phase_ = false;
  int in_phase_for_ = 0;            // arrivals, up to kArrivalsToKnow
  TimePoint phase_{};               // when the newest tick's frame was due
  std::int64_t by_time_ = 0;        // ticks since start, by the clock
  std::int64_t counted_ = 0;        // ticks since start, received and lost
  int doubtful_ = 0;                // arrivals in a row, each in another tick, with some missing
  std::int64_t least_missing_ = 0;  // at any of them
  std::int64_t given_up_ = 0;       // of the lost, those that may still come
  std::int64_t given_up_at_ = 0;    // by_time_ then
};

}  // namespace cargobay::rt
