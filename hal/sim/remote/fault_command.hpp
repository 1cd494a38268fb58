// The named faults, as text: what the control socket and the command line take.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "hal/sim/line/cable.hpp"

namespace cargobay::hal::sim {

struct FaultInfo {
  std::string_view name;
  std::string_view arguments;
  std::string_view meaning;
};

// P is a probability for each byte, 0 to 1; the direction is to-host (the default), to-robot or
// both.
inline constexpr std::array<FaultInfo, 17> kFaults{{
    {"none", "", "ends all faults of the line, and those of the robot that last"},
    {"lost", "P [DIRECTION]", "bytes are lost"},
    {"flipped", "P [DIRECTION]", "bytes arrive with one bit flipped"},
    {"duplicated", "P [DIRECTION]", "bytes arrive twice"},
    {"inserted", "P [DIRECTION]", "random bytes arrive behind others"},
    {"garbled-frame", "[COUNT]", "the next stream frames are garbled"},
    {"stalled-stream", "MS", "the stream has no frames for so long"},
    {"burst", "on|off", "bytes arrive as through a USB adapter with a 16 ms timer"},
    {"jitter", "MS", "each byte arrives up to so much later; 0 ends it"},
    {"held", "N MS", "each Nth frame is held back for so long, and what follows queues; 0 ends it"},
    {"unplugged", "", "nothing goes through the line any more"},
    {"replugged", "", "the line is whole again"},
    {"brown-out", "", "the battery fails for an instant: the robot boots and has forgotten all"},
    {"wrong-baud", "BAUD", "the robot changes its rate by itself"},
    {"half-command", "", "the robot waits for the data of a command that nobody sent"},
    {"junk-reading", "[COUNT]", "the next distances and angles read are junk"},
    {"text", "[WORDS]", "the robot prints a line, wherever its stream is"},
}};

// Applies "NAME [ARGUMENTS]". Empty, or what is wrong with it and what would be right.
std::string apply_fault(std::string_view command, Cable& cable);

}  // namespace cargobay::hal::sim
