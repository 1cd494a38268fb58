#include "hal/cli/terminal/signals.hpp"

#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>
#include <string_view>
#include <utility>

#include "hal/cli/terminal/exit_codes.hpp"

namespace cargobay::cli {
namespace {

constexpr std::chrono::milliseconds kGrace{1500};

// What the thread shares with the rest of the process. Never destroyed: the thread keeps watching
// after the command, until main() has ended, so nothing can join it.
struct Shared {
  sigset_t signals{};
  std::mutex mutex{};
  std::condition_variable news{};
  std::optional<int> unseen{};
  std::function<void()> act{};
  std::atomic<bool> any{false};
};

Shared& shared() {
  static auto& instance = *new Shared;  // NOLINT(cppcoreguidelines-owning-memory): as said above
  return instance;
}

void publish(int signal) {
  Shared& all = shared();
  const std::lock_guard lock{all.mutex};
  all.unseen = signal;
  if (!all.any.exchange(true) && all.act) all.act();
  all.news.notify_all();
}

// Not through stdio, which may be what is blocked.
void say_why() {
  constexpr std::string_view kWhy =
      "cargobay: error: killed 1.5 s after it was told to end: what it reads or writes is stuck; "
      "unwritten results are lost\n";
  pollfd waited{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  if (poll(&waited, 1, 0) == 1) (void)!write(STDERR_FILENO, kWhy.data(), kWhy.size());
}

void* take(void* set) {
  sigset_t signals = *static_cast<sigset_t*>(set);
  int first = 0;
  while (sigwait(&signals, &first) != 0) {
  }
  const rt::TimePoint end = rt::Clock::now() + kGrace;
  for (int signal = first; rt::Clock::now() < end;) {
    if (signal > 0) publish(signal);
    const timespec left = rt::as_timespec(std::max(end - rt::Clock::now(), rt::Duration::zero()));
    signal = sigtimedwait(&signals, nullptr, &left);
  }
  say_why();
  _exit(kSignalled + first);
}

// False if the system refuses.
bool start_taking(sigset_t& signals) {
  constexpr std::size_t kStackBytes = std::size_t{128} << 10U;  // may be locked with the rest
  pthread_attr_t attributes{};
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_t thread{};
  const bool started = pthread_create(&thread, &attributes, &take, &signals) == 0;
  pthread_attr_destroy(&attributes);
  return started;
}

}  // namespace

StopSignals::StopSignals(std::initializer_list<int> more) {
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&signals_, signal);
  for (const int signal : more) sigaddset(&signals_, signal);
  // Under nohup the terminal may go away; a blocked SIGHUP would still be waited for and taken.
  struct sigaction hang_up{};
  if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler == SIG_IGN)
    sigdelset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  (void)std::signal(SIGPIPE, SIG_IGN);  // cannot fail
  shared().signals = signals_;
  threaded_ = start_taking(shared().signals);
}

std::optional<int> StopSignals::wait(rt::Duration timeout) {
  if (!threaded_) {
    const timespec limit = rt::as_timespec(timeout);
    const int signal = sigtimedwait(&signals_, nullptr, &limit);
    if (signal > 0) publish(signal);
  }
  Shared& all = shared();
  std::unique_lock lock{all.mutex};
  const auto there = [&all] { return all.unseen.has_value(); };
  if (threaded_) all.news.wait_for(lock, timeout, there);
  return std::exchange(all.unseen, std::nullopt);
}

bool StopSignals::came() { return shared().any.load(std::memory_order_relaxed); }

AtFirstSignal::AtFirstSignal(std::function<void()> act) {
  const std::lock_guard lock{shared().mutex};
  shared().act = std::move(act);
}

AtFirstSignal::~AtFirstSignal() {
  const std::lock_guard lock{shared().mutex};
  shared().act = nullptr;
}

}  // namespace cargobay::cli
