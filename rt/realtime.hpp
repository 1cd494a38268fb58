// Real-time rights: what is asked of the kernel, what it gave, and how to get the rest.
#pragma once

#include <pthread.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cargobay::rt {

struct RealtimeRequest {
  int priority = 80;             // SCHED_FIFO, 1 to 98
  std::optional<int> cpu{};      // the one CPU to run on
  bool lock_memory = true;       // mlockall, now and future
  bool hold_dma_latency = true;  // keeps the CPU out of deep sleep (/dev/cpu_dma_latency at 0)
};

// Something that the kernel refused.
struct Refusal {
  enum class Right { fifo, memory_lock, affinity, dma_latency, thread };
  Right right = Right::fifo;
  int error = 0;  // errno
};
// What was refused, why, and what to do about it: one line.
std::string explain(const Refusal& refusal);

struct RealtimeGrant {
  bool fifo = false;
  int priority = 0;  // 0 where fifo is false
  bool memory_locked = false;
  std::optional<int> cpu{};
  bool dma_latency_held = false;
  std::vector<Refusal> refusals{};

  // What the loop cannot do without to be called real-time.
  bool complete() const { return fifo && memory_locked; }
};

// A thread with real-time rights as far as they can be had. Its stack, 512 KiB, is touched before
// `body` begins, so that `body` takes no page fault on it.
class RealtimeThread {
 public:
  RealtimeThread() = default;
  ~RealtimeThread() { join(); }
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

  // Locks memory, then starts the thread. Where a right is refused the thread runs without it.
  // Nothing runs, and `error` of the last refusal says why, where no thread could be made at all.
  // To be called once, before join().
  RealtimeGrant start(const RealtimeRequest& request, std::function<void()> body);
  bool running() const { return thread_.has_value(); }
  // Waits for the end of `body`, and lets go of the latency request.
  void join();

 private:
  std::function<void()> body_;
  std::optional<pthread_t> thread_;
  int dma_latency_ = -1;
};

}  // namespace cargobay::rt
