#include "hal/file/quiet_signals.hpp"

#include <ctime>
#include <initializer_list>

namespace cargobay::hal {

QuietSignals::QuietSignals() {
  sigset_t pending{};
  sigemptyset(&ours_);
  sigpending(&pending);
  for (const int signal : {SIGXFSZ, SIGPIPE}) {
    if (sigismember(&pending, signal) == 0) sigaddset(&ours_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &ours_, &before_);
}

QuietSignals::~QuietSignals() {
  constexpr timespec kAtOnce{};
  while (sigtimedwait(&ours_, nullptr, &kAtOnce) > 0) {  // each of the two once
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace cargobay::hal
