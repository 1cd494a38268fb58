#include "hal/robot/port_watch.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

#include "hal/port/pty_transport.hpp"

namespace cargobay::hal {

// Not std::thread: if all memory is locked, its 8 MiB of stack would be too, and it would inherit a
// caller's real-time priority.
std::error_code PortWatch::start(std::string port, LookUp look_up, Tell tell) {
  constexpr std::size_t kStackBytes = std::size_t{256} * 1024;
  port_ = std::move(port);
  look_up_ = std::move(look_up);
  tell_ = std::move(tell);
  blind_ = !opens_.begin(port_);
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
  opens_.end();
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
  constexpr std::chrono::milliseconds kLeastPause{100};
  std::uint64_t missed = 0;
  rt::TimePoint next_period = rt::Clock::now() + kPeriod;
  rt::TimePoint next_report = rt::TimePoint::min();
  while (wait(was_opened_ ? std::min(next_period, next_look_) : next_period)) {
    if (was_opened_ && rt::Clock::now() >= next_look_) {
      look();
      next_look_ = rt::Clock::now() + kLeastPause;
    }
    if (rt::Clock::now() < next_period) continue;
    next_period = rt::Clock::now() + kPeriod;
    const Progress progress = look_up_();
    const bool worse = progress.missed > missed;
    missed = progress.missed;
    if (worse && rt::Clock::now() >= next_report) {
      look();
      report(progress.tick);
      next_report = rt::Clock::now() + kPause;
    }
  }
}

bool PortWatch::wait(rt::TimePoint limit) {
  if (!blind_) {
    const OpenWatch::Woken woken = opens_.wait(limit);
    was_opened_ = was_opened_ || woken == OpenWatch::Woken::opened;
    blind_ = woken == OpenWatch::Woken::blind || woken == OpenWatch::Woken::ended;
  }
  std::unique_lock lock{mutex_};
  if (blind_) ending_changed_.wait_until(lock, limit, [this] { return ending_; });
  return !ending_;
}

void PortWatch::look() {
  const bool was_opened = std::exchange(was_opened_, false);
  const PortUsers users = find_port_users(port_);
  const rt::TimePoint now = rt::Clock::now();
  std::erase_if(seen_, [now](const Seen& seen) { return !seen.told && seen.last < now - kRecent; });
  for (Seen& seen : seen_) seen.present = false;
  for (const PortUser& user : users.found) {
    const auto same =
        std::ranges::find(seen_, user.id, [](const Seen& seen) { return seen.user.id; });
    if (same != seen_.end()) {
      same->last = now;
      same->present = true;
    } else if (seen_.size() < kMostEvents) {
      seen_.push_back({.user = user, .last = now});
    }
  }
  if (was_opened && users.found.empty()) unseen_at_ = now;
}

bool PortWatch::was_told_of(const std::string& name) const {
  return std::ranges::any_of(seen_, [&](const Seen& seen) {
    return seen.told && !seen.present && seen.user.name == name;
  });
}

void PortWatch::report(std::int64_t tick) {
  const rt::TimePoint since = rt::Clock::now() - kRecent;
  bool named = false;
  for (Seen& seen : seen_) {
    if (seen.last < since) continue;
    named = true;
    if (seen.told || was_told_of(seen.user.name)) continue;
    put(tick, seen.user);
    seen.told = true;
  }
  if (named || unseen_at_ < since || is_pty(port_)) return;
  if (!std::exchange(unseen_told_, true)) put(tick, {});
}

void PortWatch::put(std::int64_t tick, const PortUser& user) {
  Event event{.what = EventKind::port_shared, .tick = tick, .time = rt::Clock::now()};
  event.process = user.id;
  std::copy_n(user.name.begin(), std::min(user.name.size(), event.process_name.size() - 1),
              event.process_name.begin());
  if (tell_) tell_(event);
  const std::lock_guard lock{mutex_};
  if (events_.size() < kMostEvents) events_.push_back(event);
}

}  // namespace cargobay::hal
