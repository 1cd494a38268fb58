// Steering by a terminal's keys. A terminal says when a key is pressed, and again while it is held
// down, but never that it was let go: a key counts for 400 ms, and on while it is repeated.
#pragma once

#include <string_view>

#include "hal/cli/live/wish.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {

enum class SteeringKey : std::uint8_t {
  forward,
  back,
  left,
  right,
  stop,
  faster,
  slower,
  take,   // the lease, from whoever has it
  rearm,  // back to the mode that was lost
  quit,
  other,
};

// Letters, arrows in both of their forms, Escape. Bytes that belong to one key may come apart.
class KeyDecoder {
 public:
  // Calls `see(SteeringKey)` for each key that is complete. Escape by itself is `stop`; what
  // follows it may still turn out to be an arrow.
  template <typename See>
  void take(std::string_view bytes, See see) {
    for (const char byte : bytes) {
      if (const SteeringKey key = next(byte); key != SteeringKey::other) see(key);
    }
    if (inside_ == Inside::escape) see(SteeringKey::stop);
  }

 private:
  enum class Inside : std::uint8_t { nothing, escape, sequence };
  SteeringKey next(char byte);

  Inside inside_ = Inside::nothing;
};

// Which way to go by the keys that count now.
class HeldKeys {
 public:
  static constexpr rt::Duration kCounts = std::chrono::milliseconds{400};

  void press(SteeringKey key, rt::TimePoint now);
  void let_go() { *this = {}; }
  Wish wish(rt::TimePoint now) const;

 private:
  double forward_ = 0.0;
  double turn_ = 0.0;
  rt::TimePoint forward_until_{};
  rt::TimePoint turn_until_{};
};

}  // namespace cargobay::cli
