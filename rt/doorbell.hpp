// Wakes whoever waits for something new. The ringing side enters the kernel only if there is a
// waiter, and never waits itself.
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class Doorbell {
 public:
  // How often it has rung; wraps around.
  std::uint32_t rings() const CARGOBAY_NONBLOCKING {
    return rings_.load(std::memory_order_acquire);  // pairs with ring()
  }
  // Whoever sees the ring also sees what was published before it.
  void ring() CARGOBAY_NONBLOCKING {
    // In one order with wait(): either this sees the waiter, or the waiter sees the ring.
    rings_.fetch_add(1, std::memory_order_seq_cst);
    if (waiting_.load(std::memory_order_seq_cst) != 0) wake();
  }
  // Blocks until rings() differs from `seen`, or until `deadline`. True if it differs.
  bool wait(std::uint32_t seen, TimePoint deadline) noexcept;

 private:
  void wake() CARGOBAY_NONBLOCKING;

  std::atomic<std::uint32_t> rings_{0};
  std::atomic<std::uint32_t> waiting_{0};
};

}  // namespace cargobay::rt
