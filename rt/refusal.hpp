// What the kernel refused a real-time thread, why, and what to do about it.
#pragma once

#include <cstdint>
#include <string>

#include "rt/rights.hpp"

namespace cargobay::rt {

struct Refusal {
  enum class Right : std::uint8_t {
    fifo,
    memory_lock,   // nothing is locked
    whole_memory,  // what the thread needs is locked, but not all of the process's memory
    affinity,
    dma_latency,
    stack,  // memory for the thread's stack
    thread,
  };
  Right right = Right::fifo;
  int error = 0;   // errno
  int wanted = 0;  // for fifo: the SCHED_FIFO priority
};

// One line: what was refused and why, a colon, and what to do about it. `rights` are those of the
// thread that was refused.
std::string explain(const Refusal& refusal, const Rights& rights);
// The same with the rights that the calling thread has now. Blocks as own_rights() does; allocates.
std::string explain(const Refusal& refusal);

}  // namespace cargobay::rt
