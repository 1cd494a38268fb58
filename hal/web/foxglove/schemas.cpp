#include "hal/web/foxglove/schemas.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>

#include <nlohmann/json.hpp>

namespace cargobay::web {
namespace {

using Json = nlohmann::json;

// Members of one kind, by their names with spaces between.
struct Members {
  std::string_view kind;  // a JSON type, or one of ours
  std::string_view names;
};
struct FeedType {
  std::string_view name;
  std::array<Members, 6> members{};
};

constexpr auto kFeedTypes = std::to_array<FeedType>({
    {"hello",
     {{{"integer", "feed pid baud"},
       {"string", "cargobay program port robot"},
       {"boolean", "steerable"},
       {"number", "wheel_base_mm max_speed_mm_s tick_s setpoint_lapse_s lease_s"}}}},
    {"status", {{{"string", "stage text"}}}},
    {"state",
     {{{"integer", "tick"},
       {"number", "time_s unix_time_s battery_mv distance_mm"},
       {"string", "mode"},
       {"wheels", "target_mm_s set_mm_s estimate_mm_s command_mm_s"},
       {"boolean", "setpoint_lapsed"},
       {"place", "pose covariance"}}}},
    {"sensors", {{{"integer", "tick"}, {"number", "time_s"}}}},
    {"event", {{{"integer", "sequence tick"}, {"number", "time_s"}, {"string", "what text"}}}},
    {"statistics",
     {{{"integer", "unsent withheld refused clients missed"},
       {"object", "frames overruns period_ns frame_to_command_ns"}}}},
    {"truth", {{{"number", "time_s"}, {"wheels", "wheel_mm_s"}, {"place", "pose"}}}},
    {"virtual_create", {{{"object", "state"}}}},
    {"world",
     {{{"array", "walls boxes posts cliffs virtual_walls"}, {"number", "robot_radius_mm"}}}},
    {"holder", {{{"string", "name"}}}},
    {"missed", {{{"integer", "messages"}}}},
});

Json numbers(std::initializer_list<const char*> names) {
  Json properties = Json::object();
  for (const char* const name : names) properties[name] = {{"type", "number"}};
  return {{"type", "object"}, {"properties", properties}};
}

Json kind_schema(std::string_view kind, std::string_view name) {
  if (kind == "wheels") return numbers({"left", "right"});
  if (kind != "place") return {{"type", kind}};
  if (name == "covariance")
    return numbers({"xx_mm2", "xy_mm2", "yy_mm2", "xh_mm_rad", "yh_mm_rad", "hh_rad2"});
  return numbers({"x_mm", "y_mm", "heading_rad", "heading_deg"});
}

void add_members(Json& properties, const Members& members) {
  std::string_view names = members.names;
  while (!names.empty()) {
    const std::string_view name = names.substr(0, names.find(' '));
    names.remove_prefix(std::min(names.size(), name.size() + 1));
    properties[std::string{name}] = kind_schema(members.kind, name);
  }
}

Json list_of(const Json& items) { return {{"type", "array"}, {"items", items}}; }

Json pose() {
  return {
      {"type", "object"},
      {"properties",
       {{"position", numbers({"x", "y", "z"})}, {"orientation", numbers({"x", "y", "z", "w"})}}}};
}

Json time() {
  return {{"type", "object"},
          {"properties", {{"sec", {{"type", "integer"}}}, {"nsec", {{"type", "integer"}}}}}};
}

// A box or a cylinder.
Json solid() {
  return {{"type", "object"},
          {"properties",
           {{"pose", pose()},
            {"size", numbers({"x", "y", "z"})},
            {"bottom_scale", {{"type", "number"}}},
            {"top_scale", {{"type", "number"}}},
            {"color", numbers({"r", "g", "b", "a"})}}}};
}

}  // namespace

std::string feed_schema(std::string_view type) {
  Json properties{{"type", {{"type", "string"}}}, {"seq", {{"type", "integer"}}}};
  const auto* const found = std::ranges::find(kFeedTypes, type, &FeedType::name);
  if (found != kFeedTypes.end()) {
    for (const Members& members : found->members) add_members(properties, members);
  }
  return Json{
      {"title", "cargobay." + std::string{type}}, {"type", "object"}, {"properties", properties}}
      .dump();
}

std::string scene_update_schema() {
  const Json text{{"type", "string"}};
  const Json nothing = list_of({{"type", "object"}});
  const Json entity{{"type", "object"},
                    {"properties",
                     {{"timestamp", time()},
                      {"frame_id", text},
                      {"id", text},
                      {"lifetime", time()},
                      {"frame_locked", {{"type", "boolean"}}},
                      {"metadata", nothing},
                      {"arrows", nothing},
                      {"cubes", list_of(solid())},
                      {"spheres", nothing},
                      {"cylinders", list_of(solid())},
                      {"lines", nothing},
                      {"triangles", nothing},
                      {"texts", nothing},
                      {"models", nothing}}}};
  const Json deletion{
      {"type", "object"},
      {"properties", {{"timestamp", time()}, {"type", {{"type", "integer"}}}, {"id", text}}}};
  return Json{{"title", "foxglove.SceneUpdate"},
              {"type", "object"},
              {"properties", {{"deletions", list_of(deletion)}, {"entities", list_of(entity)}}}}
      .dump();
}

}  // namespace cargobay::web
