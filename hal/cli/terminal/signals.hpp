// The signals that end a command (SIGINT, SIGTERM, SIGHUP, SIGQUIT) as something to wait for: no
// handler runs, no call is interrupted. The end of its output counts as one: SIGPIPE.
#pragma once

#include <csignal>
#include <functional>
#include <initializer_list>
#include <optional>

#include "rt/clock.hpp"

namespace cargobay::cli {

// One per process. After the first signal the process has 1.5 s to end, whatever it is blocked in:
// then a thread, which lasts as long as the process, ends it by `_exit(128 + signal)`, or by
// `_exit(1)` if what came was the end of its output. A robot left running by that is stopped by its
// guard.
//
// The output has ended if standard output is a pipe or socket that nothing reads any more, even
// while nothing is written to it, or if a write to it failed. main() prints why, and exits with 1.
class StopSignals {
 public:
  // Blocks them, and `more`, for this thread and every thread started later. Ignores the signal
  // SIGPIPE itself: a reader that goes away must not end anything halfway.
  StopSignals(std::initializer_list<int> more = {});

  // The signal that came, each one once; nothing if none came in that time.
  std::optional<int> wait(rt::Duration timeout);
  // Whether any has come. Any thread.
  static bool came();
  // A write to standard output failed: this comes next, as SIGPIPE. Any thread; does not block.
  static void output_failed();

 private:
  sigset_t signals_{};
  bool threaded_ = false;  // if no thread could be made, wait() takes them itself
};

// Has that thread call this before it ends a process that did not end by itself: short, and without
// locks. Null for nothing.
void call_before_exit(void (*function)() noexcept);

// While it lives, the thread that takes the first of the signals also calls this: for what must not
// wait until this thread has finished printing or writing. One at a time; the function is short and
// takes no lock.
class AtFirstSignal {
 public:
  explicit AtFirstSignal(std::function<void()> act);
  ~AtFirstSignal();  // not while it is being called
  AtFirstSignal(const AtFirstSignal&) = delete;
  AtFirstSignal& operator=(const AtFirstSignal&) = delete;
};

}  // namespace cargobay::cli
