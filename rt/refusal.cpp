#include "rt/refusal.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace cargobay::rt {
namespace {

using Origin = Rights::Origin;

constexpr int kUsualPriority = 80;
constexpr int kGuardAbove = 10;  // the loop's guard runs above it
constexpr int kMostPriority = 98;

std::string size(std::uint64_t bytes) {
  constexpr std::uint64_t kKib = 1024;
  if (bytes >= kKib * kKib) return std::to_string(bytes / (kKib * kKib)) + " MiB";
  return std::to_string(bytes / kKib) + " KiB";
}

// What to write about one right, for each party that can grant it.
struct Remedy {
  const char* capability;  // without "CAP_"
  std::string container;
  std::string unit;
  std::string login;
};

std::string remedy(const Rights& rights, const Remedy& words) {
  const std::string capability = words.capability;
  switch (rights.origin) {
    case Origin::container:
      if (rights.namespaced) {
        return "start the container as root of the host with --cap-add " + capability +
               " --ulimit " + words.container + "; or set '" + words.login +
               "' in the host's /etc/security/limits.d for the user who starts it, log in again, "
               "and start it with --ulimit " +
               words.container;
      }
      return "start the container with --cap-add " + capability + " --ulimit " + words.container;
    case Origin::service:
      return "set AmbientCapabilities=CAP_" + capability + " or " + words.unit +
             " in the service's unit (systemctl edit), and restart it";
    case Origin::login: break;
  }
  return "run as root, grant CAP_" + capability + ", or set '" + words.login +
         "' in /etc/security/limits.d, which takes effect at the next login";
}

std::string fifo_remedy(const Rights& rights, int priority) {
  const int limit = std::min(priority + kGuardAbove, kMostPriority);
  return remedy(rights, {.capability = "SYS_NICE",
                         .container = "rtprio=95",
                         .unit = "LimitRTPRIO=95",
                         .login = "rtprio " + std::to_string(limit)});
}

std::string memory_remedy(const Rights& rights) {
  return remedy(rights, {.capability = "IPC_LOCK",
                         .container = "memlock=-1",
                         .unit = "LimitMEMLOCK=infinity",
                         .login = "memlock unlimited"});
}

// In the kernel's order: rights first, then control groups and filters.
std::string explain_fifo(const Rights& rights, int priority) {
  if (!rights.has(Capability::sys_nice) &&
      rights.priority_limit < static_cast<std::uint64_t>(priority)) {
    return ", without CAP_SYS_NICE and with a priority limit of " +
           std::to_string(rights.priority_limit) + ": " + fifo_remedy(rights, priority);
  }
  if (rights.no_realtime_budget) {
    return ", the control group has no real-time budget (CONFIG_RT_GROUP_SCHED): give its "
           "cpu.rt_runtime_us some, or boot with rt_group_sched=0";
  }
  if (!rights.filtered)
    return ", though the rights are there: look for a security module that forbids it (dmesg)";
  if (rights.origin == Origin::service)
    return ", by a filter of system calls: set RestrictRealtime=no in the service's unit "
           "(systemctl edit), and restart it";
  return ", by a filter of system calls: start the container with --security-opt "
         "seccomp=unconfined, or with a profile that allows sched_setscheduler";
}

std::string lock_limit(const Rights& rights) {
  if (!rights.lock_limit) return "";
  return ", without CAP_IPC_LOCK and with a limit of " + size(*rights.lock_limit);
}

std::string explain_stack(const Rights& rights, int error) {
  // mmap(2): EAGAIN is returned for locked memory only.
  if (error == EAGAIN) {
    return ", because the program locks all its future memory (MCL_FUTURE)" + lock_limit(rights) +
           ": " + memory_remedy(rights) + "; or leave MCL_FUTURE to the library";
  }
  return ": free some memory, or raise the limit of the address space (ulimit -v)";
}

std::string explain_tasks(const Rights& rights, std::uint64_t limit) {
  const std::string what =
      ", the control group is at its limit of " + std::to_string(limit) + " tasks: ";
  if (rights.origin == Origin::container)
    return what + "start the container with a higher --pids-limit";
  return what + "raise TasksMax= in the unit (systemctl edit), or end other programs of it";
}

std::string explain_memory(const Rights& rights, std::uint64_t limit) {
  const std::string what = ", the control group is at its limit of " + size(limit) + " of memory: ";
  if (rights.origin == Origin::container)
    return what + "start the container with a higher --memory";
  return what + "raise MemoryMax= in the unit (systemctl edit), or end other programs of it";
}

// The kernel and the C library report too many threads and too little memory by the same number.
std::string explain_thread(const Rights& rights) {
  constexpr std::uint64_t kLeastSpace = 1U << 20U;  // less than a thread needs besides its stack
  if (rights.task_limit) return explain_tasks(rights, *rights.task_limit);
  if (rights.address_space_left && *rights.address_space_left < kLeastSpace)
    return ", the address space is used up: raise its limit (ulimit -v)";
  if (rights.memory_limit) return explain_memory(rights, *rights.memory_limit);
  if (rights.process_limit) {
    return ", with a limit of " + std::to_string(*rights.process_limit) +
           " for all threads of this user: end some, or raise it (ulimit -u)";
  }
  return ", though no limit of this user is reached: free some memory, and see how many threads "
         "the machine has (kernel.threads-max, kernel.pid_max)";
}

std::string explain_dma_latency(const Rights& rights, int error, const std::string& why) {
  constexpr const char* kDevice = "/dev/cpu_dma_latency";
  if (error != ENOENT) {
    return kDevice + (" refused" + why) +
           ": run as root or give your group write access to it with a udev rule";
  }
  return std::string{kDevice} + " is not there, and the CPU may sleep deeply between frames: " +
         (rights.origin == Origin::container
              ? "start the container with --device /dev/cpu_dma_latency"
              : "mount /dev, or use a kernel with CONFIG_PM");
}

}  // namespace

std::string explain(const Refusal& refusal, const Rights& rights) {
  std::string why = " (" + std::generic_category().message(refusal.error) + ")";
  switch (refusal.right) {
    case Refusal::Right::fifo:
      return "SCHED_FIFO refused" + why +
             explain_fifo(rights, refusal.wanted > 0 ? refusal.wanted : kUsualPriority);
    case Refusal::Right::memory_lock:
      return "locking memory refused" + why + lock_limit(rights) + ": " + memory_remedy(rights);
    case Refusal::Right::whole_memory:
      return "only the loop's own memory is locked" + lock_limit(rights) + ": " +
             memory_remedy(rights);
    case Refusal::Right::affinity:
      return "the requested CPU refused" + why +
             ": choose one that is online (lscpu) and allowed (taskset -p)";
    case Refusal::Right::dma_latency: return explain_dma_latency(rights, refusal.error, why);
    case Refusal::Right::stack:
      return "no memory for a thread's stack" + why + explain_stack(rights, refusal.error);
    case Refusal::Right::thread: return "no thread could be created" + why + explain_thread(rights);
  }
  return why;
}

std::string explain(const Refusal& refusal) { return explain(refusal, own_rights()); }

}  // namespace cargobay::rt
