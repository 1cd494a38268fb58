#include "hal/cli/terminal/signals.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <mutex>
#include <string_view>
#include <utility>

#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/standard_streams.hpp"

namespace cargobay::cli {
namespace {

constexpr std::chrono::milliseconds kGrace{1500};

// What the thread shares with the rest of the process. Never destroyed: the thread keeps watching
// after the command, until main() has ended, so nothing can join it.
struct Shared {
  int signals = -1;                // signalfd
  int output = -1;                 // standard output; -1 if nothing can go wrong with it unnoticed
  std::atomic<int> unwritten{-1};  // eventfd: a write to standard output failed
  std::mutex mutex{};
  std::condition_variable news{};
  std::optional<int> unseen{};
  std::function<void()> act{};
  std::atomic<bool> any{false};
  std::atomic<void (*)() noexcept> before_exit{nullptr};
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
void say_why(int signal) {
  constexpr std::string_view kTold =
      "cargobay: error: killed 1.5 s after it was told to end: what it reads or writes is stuck; "
      "unwritten results are lost\n";
  constexpr std::string_view kGone =
      "cargobay: error: killed 1.5 s after its standard output was gone: what it reads or writes "
      "is stuck; unwritten results are lost\n";
  const std::string_view why = signal == SIGPIPE ? kGone : kTold;
  pollfd waited{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  if (poll(&waited, 1, 0) == 1) (void)!write(STDERR_FILENO, why.data(), why.size());
}

// Waits for a signal or the end of the output, which counts as SIGPIPE. 0 if neither came in time;
// a negative time is without end.
int next_to_end(int timeout_ms) {
  Shared& all = shared();
  constexpr short kGone = POLLERR | POLLHUP;  // reported without being asked for
  std::array<pollfd, 3> waited{{{.fd = all.signals, .events = POLLIN, .revents = 0},
                                {.fd = all.output, .events = 0, .revents = 0},
                                {.fd = all.unwritten, .events = POLLIN, .revents = 0}}};
  if (poll(waited.data(), waited.size(), timeout_ms) <= 0) return 0;
  signalfd_siginfo came{};
  if (read(all.signals, &came, sizeof came) == sizeof came) return static_cast<int>(came.ssi_signo);
  if ((waited[1].revents & kGone) == 0 && waited[2].revents == 0) return 0;
  all.output = -1;
  all.unwritten = -1;
  return SIGPIPE;
}

void* take(void* /*unused*/) {
  int first = 0;
  while (first == 0) first = next_to_end(-1);
  const rt::TimePoint end = rt::Clock::now() + kGrace;
  for (int signal = first; rt::Clock::now() < end;) {
    if (signal > 0) publish(signal);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - rt::Clock::now());
    signal = next_to_end(static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
  }
  if (auto* const restore = shared().before_exit.load(std::memory_order_acquire)) restore();
  say_why(first);
  _exit(first == SIGPIPE ? kFailure : kSignalled + first);
}

// False if the system refuses.
bool start_taking(const sigset_t& signals) {
  Shared& all = shared();
  all.signals = signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
  all.unwritten = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (all.signals < 0 || all.unwritten < 0) return false;
  // A terminal that goes away sends SIGHUP.
  all.output = isatty(STDOUT_FILENO) == 1 ? -1 : STDOUT_FILENO;
  constexpr std::size_t kStackBytes = std::size_t{128} << 10U;  // may be locked with the rest
  pthread_attr_t attributes{};
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_t thread{};
  const bool started = pthread_create(&thread, &attributes, &take, nullptr) == 0;
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
  threaded_ = start_taking(signals_);
}

std::optional<int> StopSignals::wait(rt::Duration timeout) {
  if (!threaded_) {
    const timespec limit = rt::as_timespec(timeout);
    const int signal = sigtimedwait(&signals_, nullptr, &limit);
    if (signal > 0) publish(signal);
  }
  Shared& all = shared();
  if (threaded_ && timeout <= rt::Duration::zero() && !came()) return std::nullopt;
  std::unique_lock lock{all.mutex};
  const auto there = [&all] { return all.unseen.has_value(); };
  if (threaded_) all.news.wait_for(lock, timeout, there);
  const std::optional<int> signal = std::exchange(all.unseen, std::nullopt);
  // Not before: what has printed everything by now has lost nothing.
  if (signal == SIGPIPE) note_output_is_gone();
  return signal;
}

bool StopSignals::came() { return shared().any.load(std::memory_order_relaxed); }

void StopSignals::output_failed() {
  constexpr std::uint64_t kOnce = 1;
  const int event = shared().unwritten;
  if (event >= 0) (void)!write(event, &kOnce, sizeof kOnce);
}

void call_before_exit(void (*function)() noexcept) {
  shared().before_exit.store(function, std::memory_order_release);
}

AtFirstSignal::AtFirstSignal(std::function<void()> act) {
  const std::lock_guard lock{shared().mutex};
  shared().act = std::move(act);
}

AtFirstSignal::~AtFirstSignal() {
  const std::lock_guard lock{shared().mutex};
  shared().act = nullptr;
}

}  // namespace cargobay::cli
