// The guard's port: the descriptor that it was started with, as a stream.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "hal/guard/guard_block.hpp"
#include "hal/port/tty_speed.hpp"
#include "hal/port/tty_stream.hpp"

namespace cargobay::hal {

// Beats while it waits, so that whoever waits for the guard sees that it lives.
class GuardPort final : public TtyStream {
 public:
  // `block` must outlive it.
  explicit GuardPort(GuardBlock& block)
      : TtyStream{GuardBlock::kPort, speed(block), nullptr}, block_{block} {}

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    for (;;) {
      block_.guard_beat_ns.store(rt::nanoseconds(now()), std::memory_order_relaxed);
      const Wait woken = TtyStream::wait(std::min<rt::TimePoint>(deadline, now() + kSlice));
      if (woken != Wait::timed_out || now() >= deadline) return woken;
    }
  }

 private:
  static constexpr std::chrono::milliseconds kSlice{100};

  // If the port does not report its rate, even when asked twice, it is assumed to be the wanted
  // one.
  static std::uint32_t speed(const GuardBlock& block) {
    const std::optional<std::uint32_t> first = tty_speed(GuardBlock::kPort);
    return first ? *first : tty_speed(GuardBlock::kPort).value_or(block.wanted_baud);
  }

  std::error_code apply_baud(std::uint32_t baud) override {
    return set_tty_speed(descriptor(), baud);
  }

  GuardBlock& block_;
};

}  // namespace cargobay::hal
