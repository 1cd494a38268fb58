// Counts what a real-time thread must not do. The test program has its own malloc, free and
// pthread_mutex_lock, and its own ppoll, read and write, which count and pass on; the kernel counts
// page faults. Anything that glibc does inside, without a call that could be intercepted, needs a
// system call, and the tripwire counts those. Each thread counts for itself, and only between
// begin() and end().
#pragma once

#include <cstdint>

namespace cargobay::test {

struct Calls {
  std::uint64_t heap = 0;       // malloc, calloc, realloc, free and what is built on them
  std::uint64_t locks = 0;      // mutexes, conditions, semaphores; futexes through syscall()
  std::uint64_t waits = 0;      // ppoll
  std::uint64_t time_outs = 0;  // of these
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t page_faults = 0;  // minor and major
  std::uint64_t other_calls = 0;  // other system calls, after lay_tripwire()
};

void begin_counting();
// What this thread has done since begin_counting().
Calls end_counting();

// From here to its end this thread may call the kernel only for ppoll, read, write, the clock and
// its page faults; anything else fails with ENOSYS and is counted. False if the kernel has no
// seccomp filters.
bool lay_tripwire();

// Suspends the count on this thread for as long as it lives.
class Uncounted {
 public:
  Uncounted();
  ~Uncounted();
  Uncounted(const Uncounted&) = delete;
  Uncounted& operator=(const Uncounted&) = delete;

 private:
  bool was_counting_;
};

}  // namespace cargobay::test
