#include "hal/robot/port_watch.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

#include "hal/port/port_users.hpp"

namespace cargobay::hal {

// Not std::thread: if all memory is locked, its 8 MiB of stack would be too, and it would inherit a
// caller's real-time priority.
std::error_code PortWatch::start(std::string port, LookUp look_up, Tell tell) {
  constexpr std::size_t kStackBytes = std::size_t{256} * 1024;
  port_ = std::move(port);
  look_up_ = std::move(look_up);
  tell_ = std::move(tell);
  sigset_t all;
  sigfillset(&all);
  const sched_param ordinary{};
  pthread_attr_t attributes;
  if (const int error = pthread_attr_init(&attributes); error != 0)
    return {error, std::generic_category()};
  pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_attr_setsigmask_np(&attributes, &all);
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
  pthread_attr_setschedparam(&attributes, &ordinary);
  pthread_t thread{};
  const int error = pthread_create(&thread, &attributes, &enter, this);
  pthread_attr_destroy(&attributes);
  if (error == 0) thread_ = thread;
  return {error, std::generic_category()};
}

void PortWatch::stop() {
  {
    const std::lock_guard lock{mutex_};
    ending_ = true;
  }
  ending_changed_.notify_one();
  if (thread_.has_value()) pthread_join(*thread_, nullptr);
  thread_.reset();
}

bool PortWatch::next(Event& event) {
  const std::lock_guard lock{mutex_};
  if (events_.empty()) return false;
  event = events_.front();
  events_.pop_front();
  return true;
}

void* PortWatch::enter(void* watch) {
  static_cast<PortWatch*>(watch)->run();
  return nullptr;
}

void PortWatch::run() {
  std::uint64_t missed = 0;
  rt::TimePoint next_look = rt::TimePoint::min();
  std::unique_lock lock{mutex_};
  while (!ending_changed_.wait_for(lock, kPeriod, [this] { return ending_; })) {
    lock.unlock();
    const Progress progress = look_up_();
    const bool worse = progress.missed > missed;
    missed = progress.missed;
    if (worse && rt::Clock::now() >= next_look) {
      look(progress.tick);
      next_look = rt::Clock::now() + kPause;
    }
    lock.lock();
  }
}

void PortWatch::look(std::int64_t tick) {
  for (const PortUser& user : find_port_users(port_).found) {
    if (std::ranges::find(told_, user.id) != told_.end()) continue;
    told_.push_back(user.id);
    Event event{.what = EventKind::port_shared, .tick = tick, .time = rt::Clock::now()};
    event.process = user.id;
    std::copy_n(user.name.begin(), std::min(user.name.size(), event.process_name.size() - 1),
                event.process_name.begin());
    if (tell_) tell_(event);
    const std::lock_guard lock{mutex_};
    if (events_.size() < kMostEvents) events_.push_back(event);
  }
}

}  // namespace cargobay::hal
