// The control cycle on a robot: a real one at a port, whose wheels are told to stand still, or a
// virtual Create, which also reports when a frame or a command had passed the wire.
#pragma once

#include "hal/bring_up/bring_up.hpp"
#include "hal/jitter/channel.hpp"
#include "hal/jitter/frame_source.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal::jitter {

// Brings the robot up, as in hal/bring_up/bring_up.hpp; when the channel is destroyed the robot is
// left in Passive. `server`: the virtual Create at the stream's other end, which outlives the
// channel; null for a real robot. `packets` and `left` of the bring-up are set here. Frames of a
// real robot count as complete when they wake the loop, and none is held back: `held` is for the
// virtual Create's line, like its fault `held`.
Result<std::unique_ptr<Channel>> make_robot_channel(std::unique_ptr<ByteStream> stream,
                                                    sim::Server* server, BringUpRequest bring_up,
                                                    const Settings& settings,
                                                    const HeldFrame& held = {});

}  // namespace cargobay::hal::jitter
