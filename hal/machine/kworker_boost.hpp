// Real-time priority for the kernel threads that hand a port's bytes to its reader.
//
// What arrives at a terminal reaches poll() and read() through a kworker of ordinary priority: a
// real-time program of any priority, even below the reader's, that takes the CPU delays the bytes.
// docs/realtime.md says when this is worth it, and what else these kworkers do.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "rt/clock.hpp"

namespace cargobay::hal {

// How the kernel schedules a thread. Returns an errno.
struct SchedulerCalls {
  std::function<int(pid_t thread, int priority)> set_fifo;
  std::function<int(pid_t thread)> set_ordinary;  // as it was before, its nice value included
};
SchedulerCalls kernel_scheduler();

// Call all functions from one thread.
class KworkerBoost {
 public:
  // The second and third parameters are for tests.
  explicit KworkerBoost(int priority, std::filesystem::path proc = "/proc",
                        SchedulerCalls scheduler = kernel_scheduler());
  // Stops.
  ~KworkerBoost();
  KworkerBoost(const KworkerBoost&) = delete;
  KworkerBoost& operator=(const KworkerBoost&) = delete;

  // Gives SCHED_FIFO at the priority to the kworkers that are not bound to a CPU, and within
  // kPeriod to those that the kernel adds: a thread of ordinary priority looks for them. Those at
  // another real-time priority stay as they are; those at this one were left by a process that was
  // killed, and are taken over. Blocks for some ms; allocates. If the right is refused,
  // nothing is changed and nothing runs. Call once.
  [[nodiscard]] std::error_code start();
  // Makes all of these ordinary again. Idempotent. A process that is killed leaves them as they
  // are: the next one that starts and stops a boost of this priority, or chrt, puts that right.
  void stop();

  static constexpr std::chrono::seconds kPeriod{1};

 private:
  std::error_code raise_all();
  void keep_raised();

  int priority_;
  std::filesystem::path proc_;
  SchedulerCalls scheduler_;
  std::vector<pid_t> raised_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool ending_ = false;
  std::thread thread_;
};

// The priority for a loop of that priority: one below it. While the loop waits for bytes it does
// not run, and while it runs, nothing that a kworker does may hold it up.
constexpr int kworker_priority(int loop_priority) { return loop_priority - 1; }

// What was refused, why, and what to do about it: one line, for an error of start().
std::string explain_kworker_boost(std::error_code error);

}  // namespace cargobay::hal
