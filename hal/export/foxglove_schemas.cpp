#include "hal/export/foxglove_schemas.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "hal/columns/value.hpp"
#include "hal/json_object.hpp"

namespace cargobay::hal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMetres = 1e-3;

Json object_schema(std::string_view title, const Json& properties) {
  Json required = Json::array();
  for (const auto& [name, schema] : properties.items()) required.push_back(name);
  return {{"title", title}, {"type", "object"}, {"properties", properties}, {"required", required}};
}

Json text_schema() { return {{"type", "string"}}; }

Json time_schema() {
  return {{"type", "object"},
          {"title", "time"},
          {"properties",
           {{"sec", {{"type", "integer"}, {"minimum", 0}}},
            {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}}}}}};
}

Json numbers_schema(std::string_view title, std::initializer_list<std::string_view> names) {
  Json properties = Json::object();
  for (const std::string_view name : names) properties[std::string{name}] = {{"type", "number"}};
  return object_schema(title, properties);
}

Json vector_schema() { return numbers_schema("foxglove.Vector3", {"x", "y", "z"}); }
Json quaternion_schema() { return numbers_schema("foxglove.Quaternion", {"x", "y", "z", "w"}); }
Json pose_schema() {
  return object_schema("foxglove.Pose",
                       {{"position", vector_schema()}, {"orientation", quaternion_schema()}});
}

FoxgloveSchema schema(std::string_view name, const Json& properties) {
  return {.name = name, .json = object_schema(name, properties).dump()};
}

// Members in front of the others, without the closing brace.
void open(std::string& out, std::int64_t unix_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  out += R"({"timestamp":{"sec":)";
  append_json(out, Value{unix_ns / kSecond});
  out += R"(,"nsec":)";
  append_json(out, Value{unix_ns % kSecond});
  out += '}';
}

void append_text(std::string& out, std::string_view key, std::string_view text) {
  ((out += ",\"") += key) += "\":";
  out += json_text(text);
}

void append_pose(std::string& out, const rt::OdometryPose& pose, std::string_view position,
                 std::string_view orientation) {
  ((out += '"') += position) += "\":{\"x\":";
  append_json(out, Value{pose.x_mm * kMetres});
  out += ",\"y\":";
  append_json(out, Value{pose.y_mm * kMetres});
  (out += ",\"z\":0},\"") += orientation;
  out += "\":{\"x\":0,\"y\":0,\"z\":";
  append_json(out, Value{std::sin(pose.heading_rad / 2.0)});
  out += ",\"w\":";
  append_json(out, Value{std::cos(pose.heading_rad / 2.0)});
  out += '}';
}

// As in foxglove.LogLevel.
enum class Level : std::uint8_t { info = 2, warning = 3, error = 4 };

Level level_of(EventKind what) {
  switch (what) {
    case EventKind::mode_lost:
    case EventKind::rearm_failed:
    case EventKind::wheel_stuck:
    case EventKind::counters_implausible: return Level::error;
    case EventKind::battery_low:
    case EventKind::overcurrent_began:
    case EventKind::frames_lost:
    case EventKind::silence_began:
    case EventKind::setpoint_lapsed:
    case EventKind::control_refused:
    case EventKind::port_shared: return Level::warning;
    case EventKind::rearmed:
    case EventKind::battery_recovered:
    case EventKind::overcurrent_ended:
    case EventKind::charging_began:
    case EventKind::charging_ended:
    case EventKind::silence_ended:
    case EventKind::bump_began:
    case EventKind::bump_ended:
    case EventKind::limit_began:
    case EventKind::limit_ended: return Level::info;
  }
  return Level::info;
}

double apart_mm(const rt::OdometryPose& a, const rt::OdometryPose& b) {
  return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

}  // namespace

FoxgloveSchema pose_in_frame_schema() {
  return schema(
      "foxglove.PoseInFrame",
      {{"timestamp", time_schema()}, {"frame_id", text_schema()}, {"pose", pose_schema()}});
}

FoxgloveSchema frame_transform_schema() {
  return schema("foxglove.FrameTransform", {{"timestamp", time_schema()},
                                            {"parent_frame_id", text_schema()},
                                            {"child_frame_id", text_schema()},
                                            {"translation", vector_schema()},
                                            {"rotation", quaternion_schema()}});
}

FoxgloveSchema poses_in_frame_schema() {
  return schema("foxglove.PosesInFrame",
                {{"timestamp", time_schema()},
                 {"frame_id", text_schema()},
                 {"poses", {{"type", "array"}, {"items", pose_schema()}}}});
}

FoxgloveSchema log_schema() {
  Json levels = Json::array();
  int value = 0;
  for (const char* const level : {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})
    levels.push_back({{"title", level}, {"const", value++}});
  return schema("foxglove.Log", {{"timestamp", time_schema()},
                                 {"level", {{"title", "foxglove.LogLevel"}, {"oneOf", levels}}},
                                 {"message", text_schema()},
                                 {"name", text_schema()},
                                 {"file", text_schema()},
                                 {"line", {{"type", "integer"}, {"minimum", 0}}}});
}

void append_pose_in_frame(std::string& out, std::int64_t unix_ns, const rt::OdometryPose& pose) {
  open(out, unix_ns);
  append_text(out, "frame_id", kOdometryFrame);
  out += ",\"pose\":{";
  append_pose(out, pose, "position", "orientation");
  out += "}}";
}

void append_frame_transform(std::string& out, std::int64_t unix_ns, const rt::OdometryPose& pose) {
  open(out, unix_ns);
  append_text(out, "parent_frame_id", kOdometryFrame);
  append_text(out, "child_frame_id", kRobotFrame);
  out += ',';
  append_pose(out, pose, "translation", "rotation");
  out += '}';
}

void append_poses_in_frame(std::string& out, std::int64_t unix_ns,
                           std::span<const rt::OdometryPose> poses) {
  open(out, unix_ns);
  append_text(out, "frame_id", kOdometryFrame);
  out += ",\"poses\":[";
  for (const rt::OdometryPose& pose : poses) {
    out += &pose == poses.data() ? "{" : ",{";
    append_pose(out, pose, "position", "orientation");
    out += '}';
  }
  out += "]}";
}

void append_log(std::string& out, std::int64_t unix_ns, const Event& event) {
  open(out, unix_ns);
  out += ",\"level\":";
  append_json(out, Value{static_cast<std::int64_t>(level_of(event.what))});
  append_text(out, "message", describe(event));
  append_text(out, "name", name(event.what));
  append_text(out, "file", "");
  out += ",\"line\":0}";
}

void WaySoFar::add(const rt::OdometryPose& pose) {
  // The last one is replaced until it is far enough from the one before it.
  if (poses_.size() > 1 && apart_mm(poses_[poses_.size() - 2], poses_.back()) < spacing_mm_)
    poses_.pop_back();
  poses_.push_back(pose);
  if (poses_.size() < kMost) return;
  spacing_mm_ *= 2.0;
  std::vector<rt::OdometryPose> kept;
  for (std::size_t i = 0; i < poses_.size(); i += 2) kept.push_back(poses_[i]);
  kept.push_back(pose);
  poses_ = std::move(kept);
}

}  // namespace cargobay::hal
