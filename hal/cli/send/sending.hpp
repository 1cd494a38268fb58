// What `cargobay send` does with a robot: it sends commands in order, and prints what comes back.
#pragma once

#include <optional>
#include <vector>

#include "hal/cli/send/send_plan.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/guard/duty.hpp"
#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::cli {

struct SendOptions {
  double listen_s = 1.0;
  std::optional<double> duration_s{};
  bool leave_running = false;
};

// The signal that ended it, if one did.
using Sent = hal::Result<std::optional<int>>;

// Sends the commands, one at least. A failure is returned after the clean-up that it needs: the
// wheels have been stopped, or the message says that they could not be. Its code is
// Trouble::silent if nothing answers and nothing was told to move. All are borrowed for the call.
// Waits for replies, for a script that waits, and while the wheels may turn.
Sent send_commands(hal::ByteStream& port, hal::Duty& duty, StopSignals& signals,
                   const SendOptions& options, const std::vector<PlannedCommand>& commands);

}  // namespace cargobay::cli
