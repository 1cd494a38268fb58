#include "hal/feed/world_messages.hpp"

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "hal/sim/remote/control.hpp"
#include "hal/sim/remote/fault_command.hpp"

namespace cargobay::hal {

namespace {

void put_point(JsonObject& object, sim::Point point) {
  object.number("x_mm", point.x_mm).number("y_mm", point.y_mm);
}

std::string json_of(const sim::Segment& wall) {
  JsonObject object;
  object.number("x1_mm", wall.from.x_mm)
      .number("y1_mm", wall.from.y_mm)
      .number("x2_mm", wall.to.x_mm)
      .number("y2_mm", wall.to.y_mm);
  return object.take();
}
std::string json_of(const sim::Rectangle& box) {
  JsonObject object;
  put_point(object, box.corner);
  return object.number("width_mm", box.width_mm).number("height_mm", box.height_mm).take();
}
std::string json_of(const sim::Circle& post) {
  JsonObject object;
  put_point(object, post.centre);
  return object.number("radius_mm", post.radius_mm).take();
}
std::string json_of(const sim::Beam& beam) {
  JsonObject object;
  put_point(object, beam.origin);
  return object.number("heading_deg", beam.heading_deg).take();
}

template <typename Item>
std::string array_of(const std::vector<Item>& items) {
  JsonArray array;
  for (const Item& item : items) array.raw(json_of(item));
  return array.take();
}

template <typename Row>
std::string rows_json(std::span<const Row> rows) {
  JsonArray array;
  for (const Row& row : rows) {
    JsonObject object;
    object.text("name", row.name).text("arguments", row.arguments).text("meaning", row.meaning);
    array.raw(object.take());
  }
  return array.take();
}

}  // namespace

void put_truth(JsonObject& message, const sim::NewestTruth& truth, double unix_time_s) {
  JsonObject pose;
  pose.number("x_mm", truth.pose.x_mm)
      .number("y_mm", truth.pose.y_mm)
      .number("heading_deg",
              std::remainder(truth.pose.heading_rad * 180.0 / std::numbers::pi, 360.0));
  JsonObject wheels;
  wheels.number("left", truth.speeds.left_mm_s).number("right", truth.speeds.right_mm_s);
  message.number("time_s", rt::seconds(truth.time))
      .number("unix_time_s", unix_time_s)
      .object("pose", std::move(pose))
      .object("wheel_mm_s", std::move(wheels));
}

void put_world(JsonObject& message, const sim::World& world) {
  message.raw("walls", array_of(world.walls))
      .raw("boxes", array_of(world.boxes))
      .raw("posts", array_of(world.posts))
      .raw("cliffs", array_of(world.cliffs))
      .raw("virtual_walls", array_of(world.virtual_walls))
      .raw("home_base", world.home_base ? json_of(*world.home_base) : "null")
      .number("robot_radius_mm", sim::kRobotRadiusMm);
}

void put_controls(JsonObject& message) {
  message.raw("controls", rows_json(sim::controls())).raw("faults", rows_json(sim::faults()));
}

}  // namespace cargobay::hal
