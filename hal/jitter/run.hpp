// One run of the benchmark: one slice of each channel in turn, round after round.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/bring_up/bring_up.hpp"
#include "hal/jitter/channel.hpp"
#include "hal/jitter/frame_source.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal::jitter {

// By name, in the order in which they are measured and reported. "again" is "echo" once more, under
// another name: any difference not larger than that between these two means nothing.
inline constexpr std::array<std::string_view, 6> kChannelNames{"robot", "loop", "echo",
                                                               "again", "pipe", "sleep"};

struct RunRequest {
  std::vector<std::string> channels{};  // of the names above
  Settings settings{};                  // of the channels without a robot
  std::size_t rounds = 1;
  HeldFrame held{};  // for loop and echo, and for a virtual Create's line
  // For the channel "robot": already at the right rate.
  std::unique_ptr<ByteStream> robot{};
  sim::Server* server = nullptr;  // at the robot's other end; null for a real robot
  BringUpRequest bring_up{};      // of that robot; `packets` and `left` are set here
};

class Run {
 public:
  // Makes the channels, and brings the robot up if it is one of them.
  static Result<std::unique_ptr<Run>> prepare(RunRequest request);

  // Blocks until all rounds are done or `stop` is set. `progress` is called between slices with the
  // fraction done. What was measured before a failure or a stop is kept.
  Result<void> measure(const std::atomic<bool>& stop,
                       const std::function<void(double done)>& progress);

  const std::vector<std::unique_ptr<Channel>>& channels() const { return channels_; }

 private:
  explicit Run(std::size_t rounds) : rounds_{rounds} {}

  std::size_t rounds_;
  std::vector<std::unique_ptr<Channel>> channels_;
};

}  // namespace cargobay::hal::jitter
