// How a robot is stopped and left, in one place: for the end of each drive, for the guard, for a
// bring-up that failed and for `cargobay send`.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// The wait after Start, Safe and Full; host software for this robot waits from 20 to 500 ms.
inline constexpr std::chrono::milliseconds kModeChangeWait{50};

// What became of a robot that was told to stop and go Passive.
enum class Parting : std::uint8_t {
  unconfirmed,  // it did not answer: it may be moving
  standing,     // it reported that it is Passive, or off
  port_gone,    // each time, the port accepted and delivered nothing: it may be moving
};

// Completes any command that the robot may have received the beginning of. Sends `bytes` zeros: as
// data, 0 is no speed; as an opcode, it does nothing. False if the port did not take them.
[[nodiscard]] bool complete_command(ByteStream& stream, std::size_t bytes);

// What the robot may be in the middle of.
struct Unfinished {
  std::size_t bytes = 0;  // at most this many bytes of a command are missing
  bool demo = false;      // it was told to run one
};

// Completes the command, stops the wheels, ends the stream and the demo, goes Passive and asks the
// robot whether it is. Tries three times, from the second on with as many zeros as any command
// takes. One failed call on the port, whatever its error, proves nothing and costs one try at most.
// Afterwards the stream wakes for single bytes. Blocks for up to 0.7 s at 57600 baud, 1.1 s at
// 19200; no allocation.
Parting farewell(ByteStream& stream, const Unfinished& unfinished = {});

}  // namespace cargobay::hal
