// What the control thread reports to its guard: that it lives, and what it is about to write; and
// how it sees that its guard lives. A few loads and stores of shared memory; no system call, unless
// the guard shows no sign of life.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>

#include "hal/guard/guard_block.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class GuardMark {
 public:
  // For a robot without a guard: reports nothing, and the robot is never taken.
  GuardMark() = default;
  // `block` must outlive it. `guard` is the process to watch in return, 0 for none.
  GuardMark(GuardBlock& block, pid_t guard) : block_{&block}, guard_{guard} {}

  enum class Robot : std::uint8_t {
    ours,       // go on
    taken,      // by the guard: nothing more may be sent
    unguarded,  // the guard is dead or suspended: the robot must be stopped, and is still ours
  };
  // Call once per pass of the loop.
  [[nodiscard]] Robot beat(rt::TimePoint now) CARGOBAY_NONBLOCKING {
    if (block_ == nullptr) return Robot::ours;
    const std::int64_t now_ns = rt::nanoseconds(now);
    block_->beat_ns.store(now_ns, std::memory_order_relaxed);
    switch (block_->state.load(std::memory_order_acquire)) {
      case GuardState::driving: break;
      case GuardState::guard_lost: return Robot::unguarded;
      default: return Robot::taken;
    }
    const rt::Duration silent{now_ns - block_->guard_beat_ns.load(std::memory_order_relaxed)};
    return guard_ <= 0 || silent < kSuspicious ? Robot::ours : look_after_guard(silent);
  }
  // Around each write. False, and nothing may be written, if the guard has taken the robot. A guard
  // that takes it between this call and the write first makes it Passive, in which it obeys no
  // drive command.
  [[nodiscard]] bool begin_write(std::size_t bytes) CARGOBAY_NONBLOCKING {
    if (block_ == nullptr) return true;
    // The kernel orders it before what a guard reads after this thread's death.
    block_->in_writing.store(static_cast<std::uint32_t>(bytes), std::memory_order_release);
    const GuardState state = block_->state.load(std::memory_order_acquire);
    return state == GuardState::driving || state == GuardState::guard_lost;
  }
  // All of it was written. Do not call this after a failed write: the robot may still wait for the
  // rest.
  void end_write() CARGOBAY_NONBLOCKING {
    if (block_ != nullptr) block_->in_writing.store(0, std::memory_order_release);
  }

 private:
  // Three of the guard's beats: even a tick of the loop later, a lost guard is noticed within 100
  // ms.
  static constexpr rt::Duration kSuspicious = 3 * kGuardBeat;

  Robot look_after_guard(rt::Duration silent) CARGOBAY_NONBLOCKING;

  GuardBlock* block_ = nullptr;
  pid_t guard_ = 0;
};

}  // namespace cargobay::hal
