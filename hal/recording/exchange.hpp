// What was recorded of a drive, wait by wait: for people who want to see how it ended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// One wait for the robot, and what followed. In the steady state: a frame and its answer.
struct Exchange {
  rt::TimePoint time{};  // when the wait was over
  ByteStream::Wait wait{};
  std::vector<std::uint8_t> read{};
  std::vector<std::uint8_t> written{};  // as far as the port took it
  std::optional<CycleState> state{};    // if a frame came
};

// Of checked blocks, oldest first.
std::vector<Exchange> exchanges(std::span<const Recording::Block> blocks);
// Of the blocks that the recorder still holds, oldest first: the last `frames` frames, and what
// came between and after them. From any thread; allocates.
std::vector<Exchange> last_exchanges(const FlightRecorder& recorder, std::size_t frames);

}  // namespace cargobay::hal
