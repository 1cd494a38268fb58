// Counts each tick of the robot once, by what arrives: its frame was good, bad or lost.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/cycle/cycle_state.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"
#include "rt/tick_clock.hpp"

namespace cargobay::hal {

// One thread; no allocation. The counters belong to the owner, which publishes them.
class TickLedger {
 public:
  // What a pass took from the line: `frames` (1 or more) good ones.
  struct Arrival {
    rt::TimePoint time{};
    int frames = 0;
    std::uint64_t corrupt = 0;  // candidates that were not frames, since the last arrival
    const oi::StreamDecoder::Counters& bytes;
  };
  // What the rest of the cycle must know about it.
  struct Account {
    int lost = 0;             // ticks whose frames are given up; negative: how many of those came
    int to_step = 0;          // lost ticks that the loop has not gone through
    int stepped_early = 0;    // ticks stepped through in a silence, and whose frames have come
    bool never_came = false;  // one of the lost did not, going by the bytes
    bool says_more = false;   // more bytes than frames have: the robot may have misheard a command
    bool bytes_missing = false;  // the line was dead for a while, or the robot silent
    bool incomplete = false;     // a frame is lost, or may still come
  };

  TickLedger(std::size_t frame_bytes, rt::Duration tick, rt::Duration late_margin,
             FrameCounters& counters)
      : counters_{counters},
        clock_{tick},
        frame_bytes_{frame_bytes},
        tick_{tick},
        late_margin_{late_margin} {}

  // Starts waiting.
  void begin(rt::TimePoint now) CARGOBAY_NONBLOCKING { last_arrival_ = now; }

  // Books an arrival. The first one starts the counting.
  Account book(const Arrival& arrival) CARGOBAY_NONBLOCKING;

  // A silence: from now on the robot is assumed to obey nothing. Returns how many of its ticks that
  // makes, 0 before the first frame.
  int foresee(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  // The link is lost, and with it every frame that was due by now.
  void close(rt::TimePoint now) CARGOBAY_NONBLOCKING;

  const rt::TickClock& clock() const CARGOBAY_NONBLOCKING { return clock_; }
  rt::TimePoint last_arrival() const CARGOBAY_NONBLOCKING { return last_arrival_; }
  // The deadline of the next frame.
  rt::TimePoint deadline() const CARGOBAY_NONBLOCKING { return clock_.expected() + late_margin_; }
  // Whether the frame booked last was late by more than the margin, or came with others.
  bool late() const CARGOBAY_NONBLOCKING { return late_; }
  // Whether the same frame came alone and was certainly no more than `margin` late.
  bool on_time(rt::Duration margin) const CARGOBAY_NONBLOCKING {
    return clock_.knows_phase() && frames_ == 1 &&
           last_arrival_ - clock_.due_by(last_arrival_ + margin) <= margin;
  }

 private:
  void settle(const Arrival& arrival, Account& account) CARGOBAY_NONBLOCKING;
  std::uint64_t newly_damaged(const Arrival& arrival, Account& account) CARGOBAY_NONBLOCKING;
  void take_back(std::uint64_t frames) CARGOBAY_NONBLOCKING;
  std::int64_t silent_ticks(rt::TimePoint now) const CARGOBAY_NONBLOCKING;

  FrameCounters& counters_;
  rt::TickClock clock_;
  std::size_t frame_bytes_;
  rt::Duration tick_;
  rt::Duration late_margin_;
  rt::TimePoint last_arrival_{};
  std::uint64_t bytes_ = 0;    // received up to then
  std::uint64_t skipped_ = 0;  // of these, in no frame
  std::uint64_t damaged_ = 0;  // bad frames that the clock has not missed yet
  int frames_ = 0;             // of the last arrival
  int foreseen_ = 0;           // ticks of a silence that the loop has gone through, counted or not
  bool late_ = false;
};

}  // namespace cargobay::hal
