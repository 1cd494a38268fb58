// When the wheels are held back from what is asked for, and when no longer: reports each once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "hal/sensing/events.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

// One thread; no clock, no allocation. Call once a tick.
class LimitWatch {
 public:
  // A limit of acceleration is part of every start. It is reported once it has held the wheels
  // back for so many ticks in a row, a second.
  static constexpr int kAccelerationTicks = 67;
  // The end is reported once nothing was limited for so many ticks, half a second.
  static constexpr int kFreeTicks = 34;

  // `wanted` is what was asked for, `got` what is given. Returns limit_began when a limit holds
  // that has not been reported, and limit_ended when none does.
  std::optional<Event> see(Limits now, const rt::WheelSpeeds& wanted, const rt::WheelSpeeds& got)
      CARGOBAY_NONBLOCKING {
    accelerates_ =
        now.has(Limit::acceleration) ? std::min(accelerates_ + 1, kAccelerationTicks) : 0;
    Limits counts;
    if (now.has(Limit::speed)) counts = counts.with(Limit::speed);
    if (accelerates_ == kAccelerationTicks) counts = counts.with(Limit::acceleration);
    free_ = counts.any() ? 0 : std::min(free_ + 1, kFreeTicks);
    const Limits more{static_cast<std::uint8_t>(counts.raw() & ~reported_.raw())};
    if (more.any()) {
      reported_ = Limits{static_cast<std::uint8_t>(reported_.raw() | counts.raw())};
      return Event{.what = EventKind::limit_began, .limits = more, .wanted = wanted, .got = got};
    }
    if (!reported_.any() || free_ < kFreeTicks) return std::nullopt;
    const Limits ended = reported_;
    reported_ = {};
    return Event{.what = EventKind::limit_ended, .limits = ended, .wanted = wanted, .got = got};
  }

 private:
  Limits reported_{};    // and not ended
  int accelerates_ = 0;  // ticks in a row, up to kAccelerationTicks
  int free_ = 0;         // the same without a limit, up to kFreeTicks
};

}  // namespace cargobay::hal
