#include "hal/c/handles.hpp"

#include <pthread.h>

namespace cargobay::c {
namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): the process's
std::atomic<std::uint32_t> fork_count{0};

}  // namespace

std::uint32_t forks() CARGOBAY_NONBLOCKING { return fork_count.load(std::memory_order_relaxed); }

void count_forks() {
  // The child has only one thread, and memory of its own.
  static const int kRegistered =
      pthread_atfork(nullptr, nullptr, [] { fork_count.fetch_add(1, std::memory_order_relaxed); });
  (void)kRegistered;  // fails only if memory runs out; forks then go unnoticed
}

}  // namespace cargobay::c
