// From an open port to a robot that streams frames in Safe or Full mode, and back to Passive.
//
// Runs on the stream's clock, so in virtual time as well. Each step has a time limit.
#pragma once

#include <functional>
#include <string_view>

#include "hal/byte_stream.hpp"
#include "hal/result.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"

namespace cargobay::hal {

struct BringUpRequest {
  oi::Mode mode = oi::Mode::safe;  // safe or full
  oi::StreamList packets{};        // must hold oi_mode
  // Told of each step as it begins; may be empty.
  std::function<void(std::string_view step)> progress{};
};

struct BringUpReport {
  int attempts = 1;  // 2 where the robot had to be freed from a half-sent command first
  std::int32_t battery_mv = 0;
};

// Start, mode, Stream; done when whole frames in the wanted mode arrive. Where nothing answers, a
// robot stuck in a half-sent command is freed and all is tried once more. Blocks for up to 4 s.
// After a failure the robot was told to stop and go Passive.
Result<BringUpReport> bring_up(ByteStream& stream, const BringUpRequest& request);

// Stops the wheels, ends the stream, goes Passive and waits for the robot to say so: true. Blocks
// for up to 1 s. False where the robot does not answer; it was told all the same.
bool leave(ByteStream& stream);

}  // namespace cargobay::hal
