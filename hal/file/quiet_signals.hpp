// Keeps the signals that a write() may raise away from the program that owns this thread.
#pragma once

#include <csignal>

namespace cargobay::hal {

// While this lives, SIGXFSZ and SIGPIPE are blocked on this thread; those raised meanwhile are
// consumed at the end. No disposition is changed: dispositions belong to the program.
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
