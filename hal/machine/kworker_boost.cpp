#include "hal/machine/kworker_boost.hpp"

#include <sched.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hal/machine/task_list.hpp"
#include "rt/rights.hpp"

namespace cargobay::hal {
namespace {

int set_policy(pid_t thread, int policy, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return sched_setscheduler(thread, policy, &parameters) == 0 ? 0 : errno;
}

}  // namespace

SchedulerCalls kernel_scheduler() {
  return {.set_fifo = [](pid_t thread,
                         int priority) { return set_policy(thread, SCHED_FIFO, priority); },
          .set_ordinary = [](pid_t thread) { return set_policy(thread, SCHED_OTHER, 0); }};
}

KworkerBoost::KworkerBoost(int priority, std::filesystem::path proc, SchedulerCalls scheduler)
    : priority_{priority}, proc_{std::move(proc)}, scheduler_{std::move(scheduler)} {}

KworkerBoost::~KworkerBoost() { stop(); }

std::error_code KworkerBoost::start() {
  if (const std::error_code error = raise_all()) {
    stop();
    return error;
  }
  thread_ = std::thread{[this] { keep_raised(); }};
  return {};
}

void KworkerBoost::stop() {
  {
    const std::lock_guard lock{mutex_};
    ending_ = true;
  }
  ended_.notify_one();
  if (thread_.joinable()) thread_.join();
  for (const pid_t thread : std::exchange(raised_, {})) {
    // By now the number may belong to another thread, with a priority that it was meant to have.
    const auto task = read_task(proc_ / std::to_string(thread));
    if (task && task->is_unbound_kworker() && task->priority == priority_)
      (void)scheduler_.set_ordinary(thread);  // whoever may raise it may lower it
  }
}

std::error_code KworkerBoost::raise_all() {
  std::vector<Task> kworkers = kernel_threads(proc_);
  std::erase_if(kworkers, [](const Task& task) { return !task.is_unbound_kworker(); });
  // Forget those that have ended.
  std::erase_if(raised_, [&](pid_t thread) {
    return std::ranges::find(kworkers, thread, &Task::id) == kworkers.end();
  });
  for (const Task& task : kworkers) {
    if (task.priority != 0 && task.priority != priority_) continue;
    const int error = task.priority == 0 ? scheduler_.set_fifo(task.id, priority_) : 0;
    if (error == ESRCH) continue;  // ended since
    if (error != 0) return {error, std::generic_category()};
    if (std::ranges::find(raised_, task.id) == raised_.end()) raised_.push_back(task.id);
  }
  return {};
}

void KworkerBoost::keep_raised() {
  std::unique_lock lock{mutex_};
  while (!ended_.wait_for(lock, kPeriod, [this] { return ending_; })) {
    (void)raise_all();  // if it is refused by now, the rest stays as it is
  }
}

std::string explain_kworker_boost(std::error_code error) {
  return "raising the priority of the kworkers was refused (" + error.message() + "): " +
         (rt::own_rights().origin == rt::Rights::Origin::container
              ? "start the container with --cap-add SYS_NICE --pid=host"
              : "run as root or grant CAP_SYS_NICE") +
         "; a limit for real-time priorities is not enough for kernel threads";
}

}  // namespace cargobay::hal
