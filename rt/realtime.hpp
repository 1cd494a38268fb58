// Real-time rights: what is asked of the kernel, what it gave, and how to get the rest.
#pragma once

#include <pthread.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rt/memory_lock.hpp"
#include "rt/refusal.hpp"

namespace cargobay::rt {

struct RealtimeRequest {
  int priority = 80;             // SCHED_FIFO, 1 to 98
  std::optional<int> cpu{};      // the one CPU to run on
  bool lock_memory = true;       // as MemoryLock does
  bool hold_dma_latency = true;  // keeps the CPU out of deep sleep (/dev/cpu_dma_latency at 0)
  // What the body touches beside its stack; locked where not all memory can be. Outlives the
  // thread.
  std::vector<Memory> memory{};
};

struct RealtimeGrant {
  bool fifo = false;
  int priority = 0;              // 0 where fifo is false
  bool memory_locked = false;    // all of it, or the thread's stack and RealtimeRequest::memory
  std::size_t locked_bytes = 0;  // in the second case; else 0
  std::uint64_t lock_limit_bytes = 0;  // of which so many are allowed; else 0
  std::optional<int> cpu{};
  bool dma_latency_held = false;
  std::vector<Refusal> refusals{};

  // What the loop cannot do without to be called real-time.
  bool complete() const { return fifo && memory_locked; }
};
// "memory locked", "the loop's memory locked: 3.1 of 8 MiB allowed", "memory not locked".
std::string describe_memory(const RealtimeGrant& grant);
// What was refused, why, and what to do about it: a line for each refusal, with its end of line;
// empty where nothing was. Blocks as own_rights() does.
std::string explain(const RealtimeGrant& grant);

// A thread with real-time rights as far as they can be had. Its stack, 512 KiB, is touched before
// `body` begins, so that `body` takes no page fault on it.
class RealtimeThread {
 public:
  RealtimeThread() = default;
  ~RealtimeThread() { join(); }
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

  // Locks memory, then starts the thread. Where a right is refused the thread runs without it. No
  // later allocation fails for what is locked here.
  // Nothing runs, and `error` of the last refusal says why, where no thread could be made at all.
  // To be called once, before join().
  RealtimeGrant start(const RealtimeRequest& request, std::function<void()> body);
  bool running() const { return thread_.has_value(); }
  // Waits for the end of `body`, and lets go of stack, locks and latency request.
  void join();
  // The same where `body` has ended; false, and nothing done, where it has not.
  [[nodiscard]] bool try_join();
  // Leaves the thread to itself, and lets go of the latency request. This object is still `body`'s:
  // it must never be freed.
  void detach();

 private:
  int make_stack();  // returns an errno
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
