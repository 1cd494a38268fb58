// One run of the benchmark: all channels in turn, a slice each, round after round.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/jitter/channel.hpp"
#include "hal/jitter/frame_source.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal::jitter {

// By name, in the order in which they are measured and told of. "again" is "echo" once more, under
// another name: what the two differ by is what no difference means anything below.
inline constexpr std::array<std::string_view, 6> kChannelNames{"robot", "loop", "echo",
                                                               "again", "pipe", "sleep"};

struct RunRequest {
  std::vector<std::string> channels{};  // of the names above
  Settings settings{};                  // of the channels without a robot
  std::size_t rounds = 1;
  HeldFrame held{};  // of loop and echo, and of a virtual Create's line
  // For the channel "robot": at the right rate already.
  std::unique_ptr<ByteStream> robot{};
  sim::Server* server = nullptr;  // at its other end; null for a real robot
};

class Run {
 public:
  // Makes the channels, and brings the robot up where it is one of them.
  static Result<std::unique_ptr<Run>> prepare(RunRequest request);

  // Blocks until all rounds are done or `stop` is set. `progress` is called between two slices with
  // the share that is done. What was measured before a failure or a stop stays.
  std::optional<Failure> measure(const std::atomic<bool>& stop,
                                 const std::function<void(double done)>& progress);

  const std::vector<std::unique_ptr<Channel>>& channels() const { return channels_; }

 private:
  explicit Run(std::size_t rounds) : rounds_{rounds} {}

  std::size_t rounds_;
  std::vector<std::unique_ptr<Channel>> channels_;
};

}  // namespace cargobay::hal::jitter
