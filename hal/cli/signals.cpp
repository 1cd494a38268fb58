#include "hal/cli/signals.hpp"

#include <ctime>

namespace cargobay::cli {

StopSignals::StopSignals(std::initializer_list<int> more) {
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&signals_, signal);
  for (const int signal : more) sigaddset(&signals_, signal);
  // Under nohup the terminal may go away; blocked, its signal would be waited for all the same.
  struct sigaction hang_up{};
  if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler == SIG_IGN)
    sigdelset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  (void)std::signal(SIGPIPE, SIG_IGN);  // cannot fail
}

std::optional<int> StopSignals::wait(rt::Duration timeout) {
  const timespec limit = rt::as_timespec(timeout);
  const int signal = sigtimedwait(&signals_, nullptr, &limit);
  if (signal < 0) return std::nullopt;
  return signal;
}

}  // namespace cargobay::cli
