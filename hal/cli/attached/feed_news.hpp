// What a feed has told so far (docs/feed.md), for commands that show it.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/feed/message/messages.hpp"
#include "oi/sensors.hpp"
#include "rt/odometry.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

// Durations that were measured, in nanoseconds.
struct FeedDurations {
  std::uint64_t count = 0;
  double p50_ns = 0.0;
  double p99_ns = 0.0;
  double max_ns = 0.0;
  // Upper end and count of each bucket that is not empty, ascending.
  std::vector<std::pair<double, std::uint64_t>> histogram{};
};

// Who publishes it, and of what.
struct FeedHello {
  std::string program{};
  std::string port{};
  std::string robot{};  // "robot" or "virtual Create"
  std::int64_t process = 0;
  std::int64_t baud = 0;
  bool steerable = false;
  double max_speed_mm_s = 0.0;
};

struct FeedTruth {
  rt::OdometryPose pose{};
  rt::WheelSpeeds wheels{};
};

struct FeedAnswer {
  std::string id{};  // as JSON; "null" if the request had none
  bool ok = false;
  std::string error{};
};

// What is missing in a message, or of another kind than expected, is left as it was: a feed of
// another version is shown as far as it is understood. One thread; allocates.
class FeedNews {
 public:
  static constexpr std::size_t kMostEvents = 200;  // the latest

  // Takes one line. Returns its type; nothing if it is not a message of a feed.
  std::optional<hal::FeedType> hear(std::string_view line);

  FeedHello hello{};
  std::string stage{};
  std::string text{};  // of the stage
  std::optional<hal::CycleState> state{};
  double state_unix_s = 0.0;         // arrival of its frame, on the system's clock
  oi::SensorValues sensors{};        // without those that the robot is not asked for
  std::int64_t sensors_tick = -1;    // of the robot
  std::deque<std::string> events{};  // "  12.345 s  text"
  hal::FrameCounters frames{};
  std::uint64_t unsent = 0;
  std::optional<FeedDurations> period{};
  std::optional<FeedDurations> frame_to_command{};
  std::uint64_t clients = 0;
  std::optional<FeedTruth> truth{};  // of a virtual Create
  std::string holder{};              // who steers; empty for nobody
  std::uint64_t missed = 0;          // messages that this reader was too slow for
  FeedAnswer answer{};               // the latest
};

}  // namespace cargobay::cli
