// A message of a feed (docs/feed.md) as it is read: the one place that looks its members up.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "hal/columns/records.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/feed/message/messages.hpp"
#include "rt/odometry.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

namespace heard {

// Who publishes it, and of what.
struct Hello {
  std::string program{};
  std::string port{};
  std::string robot{};  // "robot" or "virtual Create"
  std::int64_t process = 0;
  std::int64_t baud = 0;
  bool steerable = false;
  double max_speed_mm_s = 0.0;
  // All members that are one value, by their names, as JSON.
  std::vector<std::pair<std::string, std::string>> constants{};
};
struct Status {
  std::optional<std::string> stage{};
  std::string text{};
};
struct Sensors {
  std::int64_t tick = -1;  // of the robot
  SensorRecord record{};
};
struct Event {
  std::string what{};
  std::string text{};
  double robot_time_s = 0.0;
};
// Durations that were measured, in nanoseconds.
struct Durations {
  std::uint64_t count = 0;
  double p50_ns = 0.0;
  double p99_ns = 0.0;
  double max_ns = 0.0;
  // Upper end and count of each bucket that is not empty, ascending.
  std::vector<std::pair<double, std::uint64_t>> histogram{};
};
struct Statistics {
  FrameCounters frames{};
  std::uint64_t unsent = 0;
  std::uint64_t clients = 0;
  std::optional<Durations> period{};
  std::optional<Durations> frame_to_command{};
};
// Of a virtual Create.
struct Truth {
  rt::OdometryPose pose{};
  rt::WheelSpeeds wheels{};
};
// A thing of its world: millimetres, degrees.
struct WorldItem {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double to_x_mm = 0.0;  // of a wall: its other end
  double to_y_mm = 0.0;
  double width_mm = 0.0;
  double height_mm = 0.0;
  double radius_mm = 0.0;
  double heading_deg = 0.0;
};
struct World {
  std::vector<WorldItem> walls{};
  std::vector<WorldItem> boxes{};
  std::vector<WorldItem> posts{};
  std::vector<WorldItem> cliffs{};
  std::vector<WorldItem> virtual_walls{};
  std::vector<WorldItem> home_bases{};  // one, or none
};
struct Holder {
  std::optional<std::string> name{};  // of who steers
  std::uint64_t lease = 0;            // its number; 0: nobody steers
};
struct Missed {
  std::uint64_t messages = 0;
};
struct Answer {
  std::string id{};  // as JSON; "null" if the request had none
  bool ok = false;
  std::string error{};
  std::uint64_t lease = 0;  // the number of the one that was asked for and given
};
// What is for maps and hands, who read it themselves.
struct Other {};

}  // namespace heard

struct HeardMessage {
  FeedType type = FeedType::hello;
  std::int64_t unix_ns = 0;  // 0: it does not say
  std::variant<heard::Other, heard::Hello, heard::Status, StateRecord, heard::Sensors, heard::Event,
               heard::Statistics, heard::Truth, heard::World, heard::Holder, heard::Missed,
               heard::Answer>
      what{};
};

// Nothing if the line is not a message of a feed. A member that is missing, or of another kind than
// expected, leaves what it would set as above: a feed of another version is read as far as it is
// understood. Any thread; allocates.
std::optional<HeardMessage> read_message(std::string_view line);

}  // namespace cargobay::hal
