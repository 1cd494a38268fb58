// Listening to a robot without a word to it.
#pragma once

#include "hal/cli/send/sending.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::cli {

// Sends nothing. Prints frames, text and all other bytes for `listen_s`, or until a signal.
Sent listen_only(hal::ByteStream& port, StopSignals& signals, double listen_s);

}  // namespace cargobay::cli
