// What the control thread tells its guard: that it lives, and what it is about to write. A few
// stores to shared memory; no system call.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/guard_block.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class GuardMark {
 public:
  // Of a robot without a guard: nothing is told, and nobody takes anything.
  GuardMark() = default;
  // The block outlives it.
  explicit GuardMark(GuardBlock& block) : block_{&block} {}

  // Once a pass of the loop. False where the guard has taken the robot: nothing may be sent any
  // more.
  [[nodiscard]] bool beat(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING {
    if (block_ == nullptr) return true;
    block_->beat_ns.store(rt::nanoseconds(now), std::memory_order_relaxed);
    return has_robot();
  }
  // Around each write. False, and nothing may be written, where the guard has taken the robot; one
  // that takes it between this and the write has made it Passive before, where it obeys no drive
  // command.
  [[nodiscard]] bool begin_write(std::size_t bytes) noexcept CARGOBAY_NONBLOCKING {
    if (block_ == nullptr) return true;
    // The kernel orders it before what a guard reads after this thread's death.
    block_->in_writing.store(static_cast<std::uint32_t>(bytes), std::memory_order_release);
    return has_robot();
  }
  // All of it was written. Where that failed the robot may still wait for the rest.
  void end_write() noexcept CARGOBAY_NONBLOCKING {
    if (block_ != nullptr) block_->in_writing.store(0, std::memory_order_release);
  }

 private:
  bool has_robot() const noexcept CARGOBAY_NONBLOCKING {
    return block_->state.load(std::memory_order_acquire) == GuardState::driving;
  }

  GuardBlock* block_ = nullptr;
};

}  // namespace cargobay::hal
