#include "hal/cli/view/restore.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>

namespace cargobay::cli {
namespace {

struct Armed {
  int descriptor = -1;
  std::array<char, 200> leave{};
  std::size_t size = 0;
  termios found{};
  bool has_found = false;
  std::atomic<bool> now{false};  // the others are written while it is false
};
static_assert(std::atomic<bool>::is_always_lock_free);

// Initialised before main(): a signal handler may use it.
Armed& armed() {
  static constinit Armed instance;
  return instance;
}

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

// The default action follows: it is set again before this runs (SA_RESETHAND).
void on_crash(int signal) {
  restore_terminal();
  (void)raise(signal);
}

void watch_for_crashes() {
  struct sigaction action{};
  action.sa_handler = &on_crash;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
  for (const int signal : kCrashes) {
    struct sigaction present{};
    // Another's handler, such as a sanitizer's, has more to say.
    if (sigaction(signal, nullptr, &present) == 0 && present.sa_handler == SIG_DFL)
      sigaction(signal, &action, nullptr);
  }
}

}  // namespace

void arm_restore(int descriptor, std::string_view leave, const std::optional<termios>& found) {
  armed().now.store(false, std::memory_order_release);
  armed().descriptor = descriptor;
  armed().size = leave.size() <= armed().leave.size() ? leave.size() : 0;
  std::copy_n(leave.begin(), armed().size, armed().leave.begin());
  armed().has_found = found.has_value();
  if (found) armed().found = *found;
  watch_for_crashes();
  armed().now.store(true, std::memory_order_release);
}

void disarm_restore() { armed().now.store(false, std::memory_order_release); }

void restore_terminal() noexcept {
  if (!armed().now.exchange(false, std::memory_order_acq_rel)) return;
  pollfd waited{.fd = armed().descriptor, .events = POLLOUT, .revents = 0};
  if (poll(&waited, 1, 0) == 1)
    (void)!write(armed().descriptor, armed().leave.data(), armed().size);
  if (armed().has_found) tcsetattr(armed().descriptor, TCSANOW, &armed().found);
}

}  // namespace cargobay::cli
