// Real-time rights: what is asked of the kernel, what it gave, and how to get the rest.
#pragma once

#include <pthread.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "rt/memory_lock.hpp"
#include "rt/refusal.hpp"

namespace cargobay::rt {

struct RealtimeRequest {
  int priority = 80;             // SCHED_FIFO, 1 to 98
  std::optional<int> cpu{};      // the one CPU to run on
  bool lock_memory = true;       // as MemoryLock does
  bool hold_dma_latency = true;  // keeps the CPU out of deep sleep (/dev/cpu_dma_latency at 0)
  // What the body touches besides its stack; locked if not all memory can be. Must outlive the
  // thread.
  std::vector<Memory> memory{};
};

struct RealtimeGrant {
  bool fifo = false;
  int priority = 0;              // 0 if fifo is false
  bool memory_locked = false;    // all of it, or the thread's stack and RealtimeRequest::memory
  std::size_t locked_bytes = 0;  // in the second case; else 0
  std::uint64_t lock_limit_bytes = 0;  // the limit that applies to them; else 0
  std::optional<int> cpu{};
  bool dma_latency_held = false;
  std::vector<Refusal> refusals{};

  // What the loop needs to be called real-time.
  bool complete() const { return fifo && memory_locked; }
};
// Leaves this CPU to others from now on: the calling thread, and threads and processes that it
// starts later. Does nothing if the kernel refuses, or if no other CPU is left. Does not block.
void keep_off(int cpu);
// "memory locked", "the loop's memory locked: 3.1 of 8 MiB allowed", "memory not locked".
std::string describe_memory(const RealtimeGrant& grant);
// What was refused, why, and what to do about it: one line per refusal, newline included; empty if
// nothing was refused. Blocks as own_rights() does.
std::string explain(const RealtimeGrant& grant);

// A thread with as many real-time rights as the kernel grants. Its stack, 512 KiB, is touched
// before `body` begins, so that `body` takes no page fault on it.
class RealtimeThread {
 public:
  RealtimeThread() = default;
  ~RealtimeThread() { join(); }
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

  // Locks memory, then starts the thread. If a right is refused, the thread runs without it. No
  // later allocation fails because of what is locked here.
  // If no thread could be created at all, nothing runs, and `error` of the last refusal says why.
  // Call once, before join().
  RealtimeGrant start(const RealtimeRequest& request, std::function<void()> body);
  bool running() const { return thread_.has_value(); }
  // Waits for `body` to end, then releases stack, locks and latency request.
  void join();
  // The same if `body` has ended; otherwise does nothing and returns false.
  [[nodiscard]] bool try_join();
  // Leaves the thread to itself and releases the latency request. `body` still uses this object,
  // which must never be freed.
  void detach();

 private:
  std::error_code make_stack();
  void lock_memory(const RealtimeRequest& request, RealtimeGrant& grant);
  void forget();
  void let_go_of_latency();

  std::function<void()> body_;
  Memory stack_{};  // with a guard page below; a mapping of its own
  MemoryLock memory_{};
  std::optional<pthread_t> thread_;
  int dma_latency_ = -1;
};

}  // namespace cargobay::rt
