#include "hal/sim/line/line_faults.hpp"

#include <algorithm>

namespace cargobay::hal::sim {

FaultyLine::FaultyLine(std::uint64_t seed, std::size_t capacity) : random_{seed}, held_{capacity} {}

void FaultyLine::push(rt::Duration now, std::uint8_t byte) {
  if (faults_.unplugged || happens(faults_.bytes.lost)) return;
  if (happens(faults_.bytes.flipped)) {
    byte = static_cast<std::uint8_t>(byte ^ (1U << random_.below(8)));
  }
  hold(now, byte);
  if (happens(faults_.bytes.duplicated)) hold(now, byte);
  if (happens(faults_.bytes.inserted)) hold(now, static_cast<std::uint8_t>(random_.next()));
}

void FaultyLine::hold(rt::Duration now, std::uint8_t byte) {
  (void)held_.push_back({.due = let_through_at(now), .byte = byte});  // full: one more lost byte
  // A full packet does not wait for the timer.
  if (faults_.latency_timer == rt::Duration{0} || held_.size() < kAdapterBytes) return;
  for (std::size_t i = 0; i < held_.size(); ++i) held_[i].due = std::min(held_[i].due, now);
}

rt::Duration FaultyLine::let_through_at(rt::Duration now) {
  // Longer than two bytes take at the lowest rate in use.
  constexpr rt::Duration kBetweenFrames = std::chrono::milliseconds{2};
  const bool begins = now - last_push_ > kBetweenFrames;
  last_push_ = now;
  if (faults_.held_every == 0) {
    frames_ = 0;
  } else if (begins) {
    ++frames_;
  }
  rt::Duration due = now;
  if (faults_.held_every != 0 && frames_ > 0 && frames_ % faults_.held_every == 0)
    due += faults_.held_by;
  if (faults_.jitter > rt::Duration{0}) {
    due += rt::Duration{
        static_cast<std::int64_t>(random_.uniform() * static_cast<double>(faults_.jitter.count()))};
  }
  if (faults_.latency_timer > rt::Duration{0}) {
    const auto periods =
        (due.count() + faults_.latency_timer.count() - 1) / faults_.latency_timer.count();
    due = faults_.latency_timer * periods;
  }
  return due;
}

std::optional<rt::Duration> FaultyLine::next() const {
  if (held_.empty()) return std::nullopt;
  return held_.front().due;
}

std::optional<std::uint8_t> FaultyLine::pop(rt::Duration now) {
  if (held_.empty() || held_.front().due > now) return std::nullopt;
  const std::uint8_t byte = held_.front().byte;
  held_.pop_front();
  return byte;
}

}  // namespace cargobay::hal::sim
