// One thread writes, the test reads, until enough was seen: what lock-free code must survive, and
// what its broken twin must be caught at.
#pragma once

#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

namespace cargobay::rt::test {

// Left alone, the scheduler may keep two busy threads on one CPU for seconds, where they never run
// at once. While this lives the calling thread is on the first CPU that it may use; move_on() moves
// a thread to the next.
class Apart {
 public:
  Apart() {
    CPU_ZERO(&allowed_);
    pthread_getaffinity_np(pthread_self(), sizeof allowed_, &allowed_);
    pin(first_ = next(0));
  }
  ~Apart() { pthread_setaffinity_np(pthread_self(), sizeof allowed_, &allowed_); }
  Apart(const Apart&) = delete;
  Apart& operator=(const Apart&) = delete;
  void move_on() const { pin(next(first_ + 1)); }

 private:
  int next(int cpu) const {
    for (int i = 0; i < CPU_SETSIZE; ++i) {
      const int candidate = (cpu + i) % CPU_SETSIZE;
      if (CPU_ISSET(static_cast<unsigned>(candidate), &allowed_)) return candidate;
    }
    return 0;
  }
  static void pin(int cpu) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(cpu), &one);
    pthread_setaffinity_np(pthread_self(), sizeof one, &one);
  }
  cpu_set_t allowed_{};
  int first_ = 0;
};

// A broken twin does this in the middle of its work now and then, so that it is caught on any
// machine, even one with a single CPU.
inline void falter() {
  thread_local int calls = 0;
  if (++calls % 100 == 0) std::this_thread::yield();
}

inline constexpr std::uint64_t kEnough = 50'000;  // changes that the reader has to see
inline constexpr std::uint64_t kLeast = 100;      // the same if the two have to share a CPU
inline constexpr int kMostGoes = 10;

// Runs `write` on a separate thread, again and again, and `read` on this one until it returns true
// or patience runs out. Returns what the last `read` returned. Both yield now and then: they may
// have to share a CPU.
template <typename Write, typename Read>
bool contend(Write&& write, Read&& read, std::chrono::seconds patience = std::chrono::seconds{3}) {
  constexpr int kTurn = 1000;
  const Apart apart;
  std::atomic<bool> over{false};
  std::thread writer{[&] {
    apart.move_on();
    while (!over.load(std::memory_order_relaxed)) {
      for (int i = 0; i < kTurn; ++i) {
        write();
        for (int pause = 0; pause < 50; ++pause) (void)over.load(std::memory_order_relaxed);
      }
      std::this_thread::yield();
    }
  }};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  bool done = false;
  while (!done && std::chrono::steady_clock::now() < deadline) {
    for (int i = 0; i < kTurn && !done; ++i) done = read();
    std::this_thread::yield();
  }
  over.store(true, std::memory_order_relaxed);
  writer.join();
  return done;
}

}  // namespace cargobay::rt::test
