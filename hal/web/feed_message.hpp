// What is read of a feed's messages (docs/feed.md); all else goes on as it is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cargobay::web {

struct Pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
};

struct FeedAnswer {
  std::uint64_t id = 0;
  bool ok = false;
  std::string error{};
};

// Of a message what there is of these; one of another type has its type alone.
struct FeedMessage {
  std::string type{};
  std::optional<double> time_s{};       // of the robot
  std::optional<double> unix_time_s{};  // of a state
  std::optional<Pose> pose{};           // of a state or of the truth
  std::string text{};                   // of an event or a status
  std::string what{};                   // of an event, or the stage of a status
  std::optional<std::string> name{};    // of a holder
  std::optional<FeedAnswer> answer{};
};

// Nothing if the line is not an object with a type. A member of the wrong kind counts as missing.
// Any thread.
std::optional<FeedMessage> read_feed_message(std::string_view line);

// Of a world: millimetres, degrees.
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
World read_world(std::string_view line);

// The members of a `hello` that do not change, as name and JSON of the value.
struct Constant {
  std::string name{};
  std::string json{};
};
std::vector<Constant> read_constants(std::string_view line);

}  // namespace cargobay::web
