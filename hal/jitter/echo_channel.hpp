// The least that any program must do to answer a frame: one ppoll, one read of the whole frame, one
// write of a command; through a pseudo-terminal, as the loop has it, or through two pipes.
#pragma once

#include "hal/jitter/channel.hpp"
#include "hal/jitter/frame_source.hpp"

namespace cargobay::hal::jitter {

enum class EchoLine : std::uint8_t { pty, pipe };

Result<std::unique_ptr<Channel>> make_echo_channel(std::string name, EchoLine line,
                                                   const Settings& settings,
                                                   const HeldFrame& held = {});

}  // namespace cargobay::hal::jitter
