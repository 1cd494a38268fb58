// The signals that end a command (SIGINT, SIGTERM, SIGHUP, SIGQUIT) as something to wait for: no
// handler runs, no call is interrupted.
#pragma once

#include <csignal>
#include <optional>

#include "rt/clock.hpp"

namespace cargobay::cli {

class StopSignals {
 public:
  // Blocks them for this thread and every thread started after.
  StopSignals();
  // The signal that came; nothing where none came for that long.
  std::optional<int> wait(rt::Duration timeout);

 private:
  sigset_t signals_{};
};

}  // namespace cargobay::cli
