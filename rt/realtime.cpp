#include "rt/realtime.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <utility>

namespace cargobay::rt {
namespace {

constexpr std::size_t kStackBytes = std::size_t{512} * 1024;
constexpr std::size_t kPrefaultBytes = kStackBytes - std::size_t{64} * 1024;

// Writes to every page of the stack that the body may need.
[[gnu::noinline]] void prefault_stack() {
  constexpr std::size_t kPage = 4096;
  std::array<volatile std::uint8_t, kPrefaultBytes> pages{};
  for (std::size_t i = 0; i < pages.size(); i += kPage) pages[i] = 1;
}

void* enter(void* body) {
  prefault_stack();
  (*static_cast<std::function<void()>*>(body))();
  return nullptr;
}

// The request lasts as long as the descriptor is open (kernel:
// Documentation/power/pm_qos_interface).
int hold_dma_latency(RealtimeGrant& grant) {
  const int device = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t latency_us = 0;
  if (device >= 0 && write(device, &latency_us, sizeof latency_us) == sizeof latency_us) {
    grant.dma_latency_held = true;
    return device;
  }
  grant.refusals.push_back({.right = Refusal::Right::dma_latency, .error = errno});
  if (device >= 0) close(device);
  return -1;
}

// Returns an errno.
int create(pthread_t& thread, Memory stack, std::function<void()>& body, int fifo_priority,
           const std::optional<int>& cpu) {
  pthread_attr_t attributes;
  if (const int error = pthread_attr_init(&attributes); error != 0) return error;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): it is writable memory, and the thread's
  pthread_attr_setstack(&attributes, const_cast<std::byte*>(stack.data()), stack.size());
  if (fifo_priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = fifo_priority;
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
    pthread_attr_setschedparam(&attributes, &parameters);
  }
  int error = 0;
  if (cpu.has_value()) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    if (*cpu < 0 || *cpu >= CPU_SETSIZE) {
      error = EINVAL;
    } else {
      CPU_SET(static_cast<unsigned>(*cpu), &cpus);
      error = pthread_attr_setaffinity_np(&attributes, sizeof cpus, &cpus);
    }
  }
  if (error == 0) error = pthread_create(&thread, &attributes, enter, &body);
  pthread_attr_destroy(&attributes);
  return error;
}

}  // namespace

void keep_off(int cpu) {
  cpu_set_t cpus;
  if (cpu < 0 || cpu >= CPU_SETSIZE || sched_getaffinity(0, sizeof cpus, &cpus) != 0) return;
  CPU_CLR(static_cast<unsigned>(cpu), &cpus);
  if (CPU_COUNT(&cpus) > 0) (void)sched_setaffinity(0, sizeof cpus, &cpus);
}

std::string describe_memory(const RealtimeGrant& grant) {
  if (!grant.memory_locked) return "memory not locked";
  if (grant.lock_limit_bytes == 0) return "memory locked";
  constexpr double kMib = 1024.0 * 1024.0;
  std::ostringstream text;
  text << std::setprecision(2)
       << "the loop's memory locked: " << static_cast<double>(grant.locked_bytes) / kMib << " of "
       << std::setprecision(4) << static_cast<double>(grant.lock_limit_bytes) / kMib
       << " MiB allowed";
  return text.str();
}

std::string explain(const RealtimeGrant& grant) {
  std::string lines;
  if (grant.refusals.empty()) return lines;
  const Rights rights = own_rights();
  for (const Refusal& refusal : grant.refusals) lines += explain(refusal, rights) + "\n";
  return lines;
}

std::error_code RealtimeThread::make_stack() {
  const auto guard = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const memory = mmap(nullptr, guard + kStackBytes, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK, -1, 0);
  if (memory == MAP_FAILED) return {errno, std::generic_category()};
  stack_ = {static_cast<const std::byte*>(memory) + guard, kStackBytes};
  if (mprotect(memory, guard, PROT_NONE) == 0) return {};
  return {errno, std::generic_category()};
}

void RealtimeThread::lock_memory(const RealtimeRequest& request, RealtimeGrant& grant) {
  const Rights rights = own_rights();
  std::vector<Memory> needed = request.memory;
  needed.push_back(stack_);
  if (const std::error_code error = memory_.lock(needed, rights)) {
    grant.refusals.push_back({.right = Refusal::Right::memory_lock, .error = error.value()});
    return;
  }
  grant.memory_locked = true;
  if (memory_.extent() == MemoryLock::Extent::all) return;
  grant.locked_bytes = memory_.bytes();
  grant.lock_limit_bytes = rights.lock_limit.value_or(0);
  grant.refusals.push_back({.right = Refusal::Right::whole_memory, .error = ENOMEM});
}

RealtimeGrant RealtimeThread::start(const RealtimeRequest& request, std::function<void()> body) {
  RealtimeGrant grant;
  body_ = std::move(body);
  if (const std::error_code error = make_stack()) {
    grant.refusals.push_back({.right = Refusal::Right::stack, .error = error.value()});
    return grant;
  }
  if (request.lock_memory) lock_memory(request, grant);
  if (request.hold_dma_latency) dma_latency_ = hold_dma_latency(grant);

  int priority = request.priority;
  std::optional<int> cpu = request.cpu;
  pthread_t thread{};
  // First with all that was asked for, then without whatever the error points at.
  while (const int error = create(thread, stack_, body_, priority, cpu)) {
    if (cpu.has_value() && error == EINVAL) {
      grant.refusals.push_back({.right = Refusal::Right::affinity, .error = error});
      cpu.reset();
    } else if (priority > 0 && error != EAGAIN) {
      grant.refusals.push_back({.right = Refusal::Right::fifo, .error = error, .wanted = priority});
      priority = 0;
    } else {
      grant.refusals.push_back({.right = Refusal::Right::thread, .error = error});
      return grant;
    }
  }
  thread_ = thread;
  grant.fifo = priority > 0;
  grant.priority = priority;
  grant.cpu = cpu;
  return grant;
}

void RealtimeThread::join() {
  if (thread_.has_value()) pthread_join(*thread_, nullptr);
  forget();
}

bool RealtimeThread::try_join() {
  if (thread_.has_value() && pthread_tryjoin_np(*thread_, nullptr) != 0) return false;
  forget();
  return true;
}

void RealtimeThread::detach() {
  if (thread_.has_value()) pthread_detach(*thread_);
  thread_.reset();
  stack_ = {};  // the thread keeps it for ever, like its locked memory
  let_go_of_latency();
}

void RealtimeThread::let_go_of_latency() {
  if (dma_latency_ >= 0) close(dma_latency_);
  dma_latency_ = -1;
}

void RealtimeThread::forget() {
  thread_.reset();
  let_go_of_latency();
  memory_.unlock();
  if (stack_.empty()) return;
  const auto guard = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): as it was mapped
  munmap(const_cast<std::byte*>(stack_.data()) - guard, stack_.size() + guard);
  stack_ = {};
}

}  // namespace cargobay::rt
