// The signals that end a command (SIGINT, SIGTERM, SIGHUP, SIGQUIT) as something to wait for: no
// handler runs, no call is interrupted.
#pragma once

#include <csignal>
#include <functional>
#include <initializer_list>
#include <optional>

#include "rt/clock.hpp"

namespace cargobay::cli {

// One a process. From the first of them to its end it has 1.5 s, in whatever it is blocked then: a
// thread, which lasts as long as the process, ends it by `_exit(128 + signal)`. A robot that is
// left so is its guard's.
class StopSignals {
 public:
  // Blocks them, and `more`, for this thread and every thread started after. SIGPIPE is ignored
  // from here on: that nobody reads our output any more ends nothing halfway.
  StopSignals(std::initializer_list<int> more = {});

  // The signal that came, each once; nothing where none came for that long.
  std::optional<int> wait(rt::Duration timeout);
  // Whether any has come. Any thread.
  static bool came();

 private:
  sigset_t signals_{};
  bool threaded_ = false;  // where no thread could be made, wait() takes them itself
};

// While it lives, the first of the signals also does this, by the thread that takes it: for what
// must not wait until this thread is done with what it prints or writes. One at a time; it is
// short, and locks nothing.
class AtFirstSignal {
 public:
  explicit AtFirstSignal(std::function<void()> act);
  ~AtFirstSignal();  // not while it is being called
  AtFirstSignal(const AtFirstSignal&) = delete;
  AtFirstSignal& operator=(const AtFirstSignal&) = delete;
};

}  // namespace cargobay::cli
