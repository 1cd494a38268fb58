#include "hal/web/foxglove/schemas.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>

#include <nlohmann/json.hpp>

#include "hal/columns/records.hpp"
#include "hal/export/json_schema.hpp"

namespace cargobay::web {
namespace {

using Json = nlohmann::json;

// Members of one kind, by their names with spaces between.
struct Members {
  std::string_view kind;  // a JSON type, or one of ours
  std::string_view names;
};
// What a message has beside the columns of its record.
struct MessageMembers {
  hal::FeedType type;
  std::array<Members, 4> members{};
};

constexpr auto kMessages = std::to_array<MessageMembers>({
    {hal::FeedType::hello,
     {{{"integer", "feed pid baud"},
       {"string", "cargobay program port robot"},
       {"boolean", "steerable"},
       {"number", "wheel_base_mm max_speed_mm_s tick_s setpoint_lapse_s lease_s"}}}},
    {hal::FeedType::status, {{{"string", "stage text"}}}},
    {hal::FeedType::sensors, {{{"integer", "tick"}, {"number", "robot_time_s"}}}},
    {hal::FeedType::event, {{{"integer", "sequence"}}}},
    {hal::FeedType::statistics,
     {{{"integer", "unsent withheld refused clients missed"},
       {"object", "frames overruns period_ns frame_to_command_ns"}}}},
    {hal::FeedType::truth,
     {{{"number", "time_s unix_time_s"}, {"wheels", "wheel_mm_s"}, {"pose", "pose"}}}},
    {hal::FeedType::virtual_create, {{{"object", "state"}}}},
    {hal::FeedType::world,
     {{{"array", "walls boxes posts cliffs virtual_walls"}, {"number", "robot_radius_mm"}}}},
    {hal::FeedType::holder, {{{"string", "name"}, {"integer", "lease"}}}},
    {hal::FeedType::missed, {{{"integer", "messages"}}}},
});

// The record that a message is, if it is one.
const hal::TopicInfo* record_of(hal::FeedType type) {
  if (type == hal::FeedType::state) return &hal::info(hal::Topic::states);
  if (type == hal::FeedType::sensors) return &hal::info(hal::Topic::sensors);
  if (type == hal::FeedType::event) return &hal::info(hal::Topic::events);
  return nullptr;
}

Json numbers(std::initializer_list<const char*> names) {
  Json properties = Json::object();
  for (const char* const name : names) properties[name] = {{"type", "number"}};
  return {{"type", "object"}, {"properties", properties}};
}

Json kind_schema(std::string_view kind) {
  if (kind == "wheels") return numbers({"left", "right"});
  if (kind == "pose") return numbers({"x_mm", "y_mm", "heading_deg"});
  return {{"type", kind}};
}

void add_members(Json& properties, const Members& members) {
  std::string_view names = members.names;
  while (!names.empty()) {
    const std::string_view name = names.substr(0, names.find(' '));
    names.remove_prefix(std::min(names.size(), name.size() + 1));
    properties[std::string{name}] = kind_schema(members.kind);
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

std::string feed_schema(hal::FeedType type) {
  Json schema{{"type", "object"}};
  if (const hal::TopicInfo* const record = record_of(type))
    schema = Json::parse(hal::json_schema(*record));
  schema["title"] = "cargobay." + std::string{hal::name(type)};
  Json& properties = schema["properties"];
  properties["type"] = {{"type", "string"}};
  properties["seq"] = {{"type", "integer"}};
  const auto* const found = std::ranges::find(kMessages, type, &MessageMembers::type);
  if (found != kMessages.end()) {
    for (const Members& members : found->members) add_members(properties, members);
  }
  return schema.dump();
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
