#include "rt/doorbell.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>

#include "rt/unchecked.hpp"

namespace cargobay::rt {
namespace {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t));

// The kernel's operation that takes an absolute CLOCK_MONOTONIC deadline (futex(2)).
void futex_wait(std::atomic<std::uint32_t>& word, std::uint32_t value, TimePoint deadline) {
  const timespec until = as_timespec(deadline.time_since_epoch());
  syscall(SYS_futex, &word, FUTEX_WAIT_BITSET_PRIVATE, value, &until, nullptr,
          FUTEX_BITSET_MATCH_ANY);
}

}  // namespace

bool Doorbell::wait(std::uint32_t seen, TimePoint deadline) noexcept {
  waiting_.fetch_add(1, std::memory_order_seq_cst);
  // Woken, interrupted or timed out: look again.
  while (rings_.load(std::memory_order_seq_cst) == seen && Clock::now() < deadline) {
    futex_wait(rings_, seen, deadline);
  }
  waiting_.fetch_sub(1, std::memory_order_relaxed);
  return rings() != seen;
}

// Wakes; does not wait.
void Doorbell::wake() CARGOBAY_NONBLOCKING {
  unchecked([this]() noexcept {
    syscall(SYS_futex, &rings_, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
  });
}

}  // namespace cargobay::rt
