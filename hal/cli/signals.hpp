// The signals that end a command (SIGINT, SIGTERM, SIGHUP, SIGQUIT) as something to wait for: no
// handler runs, no call is interrupted.
#pragma once

#include <csignal>
#include <initializer_list>
#include <optional>

#include "rt/clock.hpp"

namespace cargobay::cli {

class StopSignals {
 public:
  // Blocks them, and `more`, for this thread and every thread started after. SIGPIPE is ignored
  // from here on: that nobody reads our output any more ends nothing halfway.
  StopSignals(std::initializer_list<int> more = {});
  // The signal that came; nothing where none came for that long.
  std::optional<int> wait(rt::Duration timeout);

 private:
  sigset_t signals_{};
};

}  // namespace cargobay::cli
