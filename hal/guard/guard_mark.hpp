// What the control thread tells its guard: that it lives, and what it is about to write; and how it
// sees that its guard lives. A few loads and stores of shared memory; no system call, unless the
// guard gives no sign of life.
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
  // Of a robot without a guard: nothing is told, and nobody takes anything.
  GuardMark() = default;
  // The block outlives it. `guard` is the process that is watched in return, 0 for none.
  GuardMark(GuardBlock& block, pid_t guard) : block_{&block}, guard_{guard} {}

  enum class Robot : std::uint8_t {
    ours,       // go on
    taken,      // by the guard: nothing may be sent any more
    unguarded,  // the guard is dead or suspended: the robot is to be stopped, and is still ours
  };
  // Once a pass of the loop.
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
  // Around each write. False, and nothing may be written, where the guard has taken the robot; one
  // that takes it between this and the write has made it Passive before, where it obeys no drive
  // command.
  [[nodiscard]] bool begin_write(std::size_t bytes) CARGOBAY_NONBLOCKING {
    if (block_ == nullptr) return true;
    // The kernel orders it before what a guard reads after this thread's death.
    block_->in_writing.store(static_cast<std::uint32_t>(bytes), std::memory_order_release);
    const GuardState state = block_->state.load(std::memory_order_acquire);
    return state == GuardState::driving || state == GuardState::guard_lost;
  }
  // All of it was written. Where that failed the robot may still wait for the rest.
  void end_write() CARGOBAY_NONBLOCKING {
    if (block_ != nullptr) block_->in_writing.store(0, std::memory_order_release);
  }

 private:
  // Three of the guard's beats, and no tick of the loop more than 100 ms allow.
  static constexpr rt::Duration kSuspicious = 3 * kGuardBeat;

  Robot look_after_guard(rt::Duration silent) CARGOBAY_NONBLOCKING;

  GuardBlock* block_ = nullptr;
  pid_t guard_ = 0;
};

}  // namespace cargobay::hal
