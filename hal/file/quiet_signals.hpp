// Keeps the signals that a write() may raise from the program whose thread this is.
#pragma once

#include <csignal>

namespace cargobay::hal {

// While it lives, SIGXFSZ and SIGPIPE are blocked on this thread; what came of them meanwhile is
// taken away at the end. No disposition is changed: they are the program's.
class QuietSignals {
 public:
  QuietSignals();
  ~QuietSignals();
  QuietSignals(const QuietSignals&) = delete;
  QuietSignals& operator=(const QuietSignals&) = delete;

 private:
  sigset_t ours_{};    // of the two, those that were not pending before
  sigset_t before_{};  // the thread's mask
};

}  // namespace cargobay::hal
