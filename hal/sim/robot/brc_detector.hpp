// Judges the pulses on the Baud Rate Change pin: from 2 s after power-on, three low pulses of 50 to
// 500 ms set the robot to 19200 baud (OI p. 5).
#pragma once

#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class BrcDetector {
 public:
  static constexpr rt::Duration kAfterPowerOn = std::chrono::seconds{2};
  static constexpr rt::Duration kShortestPulse = std::chrono::milliseconds{50};
  static constexpr rt::Duration kLongestPulse = std::chrono::milliseconds{500};
  static constexpr int kPulses = 3;

  // Starts over; pulses count from 2 s after this.
  constexpr void power_on(rt::Duration now) {
    listens_from_ = now + kAfterPowerOn;
    pulses_ = 0;
  }
  // The pin's level from now on. True if this ends the third pulse; a pulse that is too short, too
  // long or too early restarts the count.
  constexpr bool set_level(bool high, rt::Duration now) {
    if (high == high_) return false;
    high_ = high;
    if (!high) {
      fell_at_ = now;
      return false;
    }
    const rt::Duration width = now - fell_at_;
    const bool good =
        fell_at_ >= listens_from_ && width >= kShortestPulse && width <= kLongestPulse;
    pulses_ = good ? pulses_ + 1 : 0;
    if (pulses_ < kPulses) return false;
    pulses_ = 0;
    return true;
  }
  constexpr bool high() const { return high_; }

 private:
  bool high_ = true;  // pulled up
  int pulses_ = 0;
  rt::Duration listens_from_ = kAfterPowerOn;
  rt::Duration fell_at_{0};
};

}  // namespace cargobay::hal::sim
