// The control cycle as it ships, on frames that come every period instead of every 15 ms: decoder,
// estimator, controller, accounting and recorder, over a pseudo-terminal.
#pragma once

#include "hal/jitter/channel.hpp"
#include "hal/jitter/frame_source.hpp"

namespace cargobay::hal::jitter {

Result<std::unique_ptr<Channel>> make_loop_channel(const Settings& settings,
                                                   const HeldFrame& held = {});

}  // namespace cargobay::hal::jitter
