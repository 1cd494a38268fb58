#include "hal/web/foxglove/drawn.hpp"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "hal/export/foxglove_schemas.hpp"

namespace cargobay::web {
namespace {

using Json = nlohmann::json;
using hal::heard::WorldItem;

constexpr double kHeightMetres = 0.15;     // of walls, boxes and posts
constexpr double kThicknessMetres = 0.02;  // of a wall
constexpr double kFloorMetres = 0.002;     // of what lies on the floor
constexpr double kBeamMetres = 2.0;        // drawn length of a virtual wall
constexpr double kBaseMetres = 0.15;

struct Colour {
  double r = 0.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;
};
constexpr Colour kWall{.r = 0.45, .g = 0.45, .b = 0.5};
constexpr Colour kBox{.r = 0.6, .g = 0.5, .b = 0.35};
constexpr Colour kPost{.r = 0.5, .g = 0.4, .b = 0.6};
constexpr Colour kCliff{.r = 0.1, .g = 0.1, .b = 0.1, .a = 0.8};
constexpr Colour kBeam{.r = 0.9, .g = 0.2, .b = 0.2, .a = 0.5};
constexpr Colour kBase{.r = 0.1, .g = 0.6, .b = 0.3};

Json time(std::int64_t unix_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {{"sec", unix_ns / kSecond}, {"nsec", unix_ns % kSecond}};
}

double metres(double mm) { return mm / 1e3; }
double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

struct Size {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

Json solid(const Pose& pose, const Size& size, const Colour& colour) {
  return {{"pose",
           {{"position", {{"x", pose.x_m}, {"y", pose.y_m}, {"z", size.z / 2.0}}},
            {"orientation",
             {{"x", 0.0},
              {"y", 0.0},
              {"z", std::sin(pose.heading_rad / 2.0)},
              {"w", std::cos(pose.heading_rad / 2.0)}}}}},
          {"size", {{"x", size.x}, {"y", size.y}, {"z", size.z}}},
          {"color", {{"r", colour.r}, {"g", colour.g}, {"b", colour.b}, {"a", colour.a}}}};
}

Json wall(const Pose& origin, const WorldItem& item) {
  const double x = metres(item.to_x_mm - item.x_mm);
  const double y = metres(item.to_y_mm - item.y_mm);
  const Pose middle{.x_m = metres(item.x_mm) + x / 2.0,
                    .y_m = metres(item.y_mm) + y / 2.0,
                    .heading_rad = std::atan2(y, x)};
  return solid(placed_in(origin, middle), {std::hypot(x, y), kThicknessMetres, kHeightMetres},
               kWall);
}

Json rectangle(const Pose& origin, const WorldItem& item, double height_m, const Colour& colour) {
  const Pose middle{.x_m = metres(item.x_mm + item.width_mm / 2.0),
                    .y_m = metres(item.y_mm + item.height_mm / 2.0)};
  return solid(placed_in(origin, middle), {metres(item.width_mm), metres(item.height_mm), height_m},
               colour);
}

Json post(const Pose& origin, const WorldItem& item) {
  const Pose middle{.x_m = metres(item.x_mm), .y_m = metres(item.y_mm)};
  const double width = metres(2.0 * item.radius_mm);
  Json cylinder = solid(placed_in(origin, middle), {width, width, kHeightMetres}, kPost);
  cylinder["bottom_scale"] = 1.0;
  cylinder["top_scale"] = 1.0;
  return cylinder;
}

// From its origin the way it faces.
Json beam(const Pose& origin, const WorldItem& item) {
  const double heading = radians(item.heading_deg);
  const Pose middle{.x_m = metres(item.x_mm) + std::cos(heading) * kBeamMetres / 2.0,
                    .y_m = metres(item.y_mm) + std::sin(heading) * kBeamMetres / 2.0,
                    .heading_rad = heading};
  return solid(placed_in(origin, middle), {kBeamMetres, kThicknessMetres, kFloorMetres}, kBeam);
}

Json base(const Pose& origin, const WorldItem& item) {
  const Pose middle{
      .x_m = metres(item.x_mm), .y_m = metres(item.y_mm), .heading_rad = radians(item.heading_deg)};
  return solid(placed_in(origin, middle), {kBaseMetres / 3.0, kBaseMetres, kHeightMetres / 3.0},
               kBase);
}

}  // namespace

Pose in_metres(const rt::OdometryPose& pose) {
  return {.x_m = metres(pose.x_mm), .y_m = metres(pose.y_mm), .heading_rad = pose.heading_rad};
}

rt::OdometryPose in_millimetres(const Pose& pose) {
  return {.x_mm = pose.x_m * 1e3, .y_mm = pose.y_m * 1e3, .heading_rad = pose.heading_rad};
}

Pose placed_in(const Pose& frame, const Pose& relative) {
  const double c = std::cos(frame.heading_rad);
  const double s = std::sin(frame.heading_rad);
  return {.x_m = frame.x_m + c * relative.x_m - s * relative.y_m,
          .y_m = frame.y_m + s * relative.x_m + c * relative.y_m,
          .heading_rad = frame.heading_rad + relative.heading_rad};
}

Pose seen_from(const Pose& frame, const Pose& pose) {
  const double c = std::cos(frame.heading_rad);
  const double s = std::sin(frame.heading_rad);
  const double x = pose.x_m - frame.x_m;
  const double y = pose.y_m - frame.y_m;
  return {.x_m = c * x + s * y,
          .y_m = -s * x + c * y,
          .heading_rad = pose.heading_rad - frame.heading_rad};
}

std::string scene_update(std::int64_t unix_ns, const hal::heard::World& world, const Pose& origin) {
  Json cubes = Json::array();
  Json cylinders = Json::array();
  for (const WorldItem& item : world.walls) cubes.push_back(wall(origin, item));
  for (const WorldItem& item : world.boxes)
    cubes.push_back(rectangle(origin, item, kHeightMetres, kBox));
  for (const WorldItem& item : world.cliffs)
    cubes.push_back(rectangle(origin, item, kFloorMetres, kCliff));
  for (const WorldItem& item : world.posts) cylinders.push_back(post(origin, item));
  for (const WorldItem& item : world.virtual_walls) cubes.push_back(beam(origin, item));
  for (const WorldItem& item : world.home_bases) cubes.push_back(base(origin, item));
  const Json none = Json::array();
  const Json entity{{"timestamp", time(unix_ns)},
                    {"frame_id", hal::kOdometryFrame},
                    {"id", "world"},
                    {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                    {"frame_locked", false},
                    {"metadata", none},
                    {"arrows", none},
                    {"cubes", cubes},
                    {"spheres", none},
                    {"cylinders", cylinders},
                    {"lines", none},
                    {"triangles", none},
                    {"texts", none},
                    {"models", none}};
  return Json{{"deletions", none}, {"entities", Json::array({entity})}}.dump();
}

std::string log_message(std::int64_t unix_ns, std::string_view name, std::string_view text,
                        bool is_warning) {
  return Json{{"timestamp", time(unix_ns)},
              {"level", is_warning ? 3 : 2},
              {"message", text},
              {"name", name},
              {"file", ""},
              {"line", 0}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace cargobay::web
