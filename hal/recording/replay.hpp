// Runs a control cycle on what another one received, and finds the first difference in what it
// does.
//
// The cycle is the shipping one, on a byte stream that returns what was recorded: the outcome of
// each wait, the bytes of each read, the time whenever the clock is asked. It is compared in every
// byte that it writes, in what it asks of the stream and in which order, and in the state of every
// tick, bit for bit. What was wanted of the wheels is an input, taken from the recording. When a
// stop was requested, a guard took the robot or a silence was announced is not recorded: it is
// inferred from how the recording goes on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/recording.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

struct ReplayDifference {
  std::int64_t tick = 0;       // the last one that was the same
  rt::Duration since_start{};  // of the recording
  std::string what{};          // in words: bytes written, left estimate, ...
  std::string recorded{};
  std::string replayed{};
};

struct ReplayResult {
  std::uint64_t frames = 0;    // states compared
  std::uint64_t commands = 0;  // writes compared
  std::optional<ReplayDifference> difference{};
  std::optional<CycleEnd> end{};  // as recorded; nothing if the recording stops before
};

// Compares up to the first missing block. Fails if that is the very first: then it is not known how
// the cycle began. Takes a small fraction of the recorded time. `observer` is told the states that
// are the same as the recorded ones, and the events up to the first difference; neither a request
// nor the end. It may allocate.
Result<ReplayResult> replay(const Recording& recording, const StateObserver& observer = {});

}  // namespace cargobay::hal
