#include "rt/tick_clock.hpp"

#include <algorithm>

namespace cargobay::rt {
namespace {

// How much of a late arrival counts as drift, per tick: 1000 ppm of 15 ms.
constexpr Duration kMostDrift = std::chrono::microseconds{15};
// Frames handed over every 16 ms are late by more than three quarters of a tick four or five times
// in a row, before two come together: hence TickClock::kPatience. More missing frames than
// kMostLate are not late in this way; then the wait is only for a bunch that is still being handed
// over.
constexpr std::int64_t kMostLate = 2;
constexpr int kShortPatience = 2;
// Ticks within which a frame that was given up may still arrive.
constexpr std::int64_t kMemory = 67;

}  // namespace

void TickClock::start(TimePoint arrival) CARGOBAY_NONBLOCKING {
  started_ = true;
  in_phase_ = false;
  in_phase_for_ = 0;
  phase_ = arrival;
  by_time_ = 0;
  counted_ = 0;
  doubtful_ = 0;
  given_up_ = 0;
}

int TickClock::arrived(TimePoint arrival, int frames, std::uint64_t damaged) CARGOBAY_NONBLOCKING {
  const std::int64_t passed = std::max<std::int64_t>(0, (arrival - phase_ + early_) / tick_);
  by_time_ += passed;
  phase_ += passed * tick_;
  counted_ += frames;
  in_phase_ = true;
  const std::int64_t back = take_back(arrival);
  if (counted_ > by_time_) {  // the robot is faster than its phase said
    in_phase_ = phase_ + tick_ - arrival < early_;
    by_time_ = counted_;
    phase_ = arrival;
  }
  in_phase_for_ = in_phase_ ? std::min(in_phase_for_ + 1, kArrivalsToKnow) : 0;
  const std::int64_t lost = settle(passed, damaged);
  counted_ += lost;
  if (lost > 0) {
    given_up_ += lost;
    given_up_at_ = by_time_;
  }
  // While frames are missing, this arrival may belong to an earlier tick, and be very late. After a
  // loss it may still do so, and seem early.
  const Duration most_early = given_up_ > 0 ? kMostDrift : tick_;
  if (missing() == 0) phase_ += std::clamp<Duration>(arrival - phase_, -most_early, kMostDrift);
  return static_cast<int>(lost - back);
}

// If there are more frames than ticks, and too early for the next: how many had been given up.
std::int64_t TickClock::take_back(TimePoint arrival) CARGOBAY_NONBLOCKING {
  if (by_time_ - given_up_at_ > kMemory) given_up_ = 0;
  const bool early = phase_ + tick_ - arrival >= early_;
  if (counted_ <= by_time_ || !early) return 0;
  const std::int64_t back = std::min(given_up_, counted_ - by_time_);
  given_up_ -= back;
  counted_ -= back;
  return back;
}

TimePoint TickClock::due_by(TimePoint time) const CARGOBAY_NONBLOCKING {
  const Duration since = time - phase_;
  const std::int64_t ticks = since / tick_ - (since % tick_ < Duration::zero() ? 1 : 0);
  return phase_ + ticks * tick_;
}

bool TickClock::in_doubt() const CARGOBAY_NONBLOCKING {
  return doubtful_ > 0 && least_missing_ > kMostLate;
}

// How many of the missing frames to give up.
std::int64_t TickClock::settle(std::int64_t passed, std::uint64_t damaged) CARGOBAY_NONBLOCKING {
  const auto seen_damaged =
      static_cast<std::int64_t>(std::min(damaged, static_cast<std::uint64_t>(missing())));
  const std::int64_t doubtful = missing() - seen_damaged;
  least_missing_ = doubtful_ == 0 ? doubtful : std::min(least_missing_, doubtful);
  if (doubtful == 0) {
    doubtful_ = 0;
  } else if (passed > 0) {
    ++doubtful_;
  }
  const int patience = least_missing_ > kMostLate ? kShortPatience : kPatience;
  if (doubtful_ < patience) return seen_damaged;
  doubtful_ = 0;
  return seen_damaged + least_missing_;
}

}  // namespace cargobay::rt
