#include "rt/realtime.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>
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

// With a finite limit, locking all future memory makes later allocations fail: then only what is
// there is locked.
int lock_memory() {
  rlimit limit{};
  const bool unlimited =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  return mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0 ? 0 : errno;
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
  grant.refusals.push_back({Refusal::Right::dma_latency, errno});
  if (device >= 0) close(device);
  return -1;
}

// Returns an errno.
int create(pthread_t& thread, std::function<void()>& body, int fifo_priority,
           const std::optional<int>& cpu) {
  pthread_attr_t attributes;
  if (const int error = pthread_attr_init(&attributes); error != 0) return error;
  pthread_attr_setstacksize(&attributes, kStackBytes);
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

std::string explain(const Refusal& refusal) {
  std::string why = " (" + std::generic_category().message(refusal.error) + ")";
  switch (refusal.right) {
    case Refusal::Right::fifo:
      return "SCHED_FIFO refused" + why +
             ": run as root, grant CAP_SYS_NICE, or set 'rtprio 90' in /etc/security/limits.d";
    case Refusal::Right::memory_lock:
      return "locking memory refused" + why +
             ": run as root, grant CAP_IPC_LOCK, or set 'memlock unlimited' in "
             "/etc/security/limits.d";
    case Refusal::Right::affinity:
      return "the wanted CPU refused" + why +
             ": choose one that is online (lscpu) and allowed (taskset -p)";
    case Refusal::Right::dma_latency:
      if (refusal.error == ENOENT) {
        return "/dev/cpu_dma_latency is not there: the CPU may sleep deeply between frames; mount "
               "/dev, "
               "or use a kernel with CONFIG_PM";
      }
      return "/dev/cpu_dma_latency refused" + why +
             ": run as root or give your group write access to it by a udev rule";
    case Refusal::Right::thread:
      return "no thread could be made" + why + ": allow more of them (ulimit -u, or TasksMax=)";
  }
  return why;
}

RealtimeGrant RealtimeThread::start(const RealtimeRequest& request, std::function<void()> body) {
  RealtimeGrant grant;
  body_ = std::move(body);
  if (request.lock_memory) {
    const int error = lock_memory();
    grant.memory_locked = error == 0;
    if (error != 0) grant.refusals.push_back({Refusal::Right::memory_lock, error});
  }
  if (request.hold_dma_latency) dma_latency_ = hold_dma_latency(grant);

  int priority = request.priority;
  std::optional<int> cpu = request.cpu;
  pthread_t thread{};
  // With all that was asked for; then without what the error points at.
  while (const int error = create(thread, body_, priority, cpu)) {
    if (cpu.has_value() && error == EINVAL) {
      grant.refusals.push_back({Refusal::Right::affinity, error});
      cpu.reset();
    } else if (priority > 0 && error != EAGAIN) {
      grant.refusals.push_back({Refusal::Right::fifo, error});
      priority = 0;
    } else {
      grant.refusals.push_back({Refusal::Right::thread, error});
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
  thread_.reset();
  if (dma_latency_ >= 0) close(dma_latency_);
  dma_latency_ = -1;
}

}  // namespace cargobay::rt
