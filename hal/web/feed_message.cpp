#include "hal/web/feed_message.hpp"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

namespace cargobay::web {
namespace {

using Json = nlohmann::json;

const Json* member(const Json& object, std::string_view key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::optional<double> number(const Json& object, std::string_view key) {
  const Json* const value = member(object, key);
  if (value == nullptr || !value->is_number()) return std::nullopt;
  return value->get<double>();
}

std::optional<std::string> text(const Json& object, std::string_view key) {
  const Json* const value = member(object, key);
  if (value == nullptr || !value->is_string()) return std::nullopt;
  return value->get<std::string>();
}

std::optional<Pose> pose_of(const Json& message) {
  const Json* const pose = member(message, "pose");
  if (pose == nullptr) return std::nullopt;
  const auto x_mm = number(*pose, "x_mm");
  const auto y_mm = number(*pose, "y_mm");
  auto heading_rad = number(*pose, "heading_rad");
  if (const auto heading_deg = number(*pose, "heading_deg"))
    heading_rad = *heading_deg * std::numbers::pi / 180.0;
  if (!x_mm || !y_mm || !heading_rad) return std::nullopt;
  return Pose{.x_m = *x_mm / 1e3, .y_m = *y_mm / 1e3, .heading_rad = *heading_rad};
}

std::optional<FeedAnswer> answer_of(const Json& message) {
  const Json* const id = member(message, "id");
  const Json* const ok = member(message, "ok");
  if (id == nullptr || !id->is_number_unsigned() || ok == nullptr || !ok->is_boolean())
    return std::nullopt;
  return FeedAnswer{.id = id->get<std::uint64_t>(),
                    .ok = ok->get<bool>(),
                    .error = text(message, "error").value_or("")};
}

WorldItem item_of(const Json& object) {
  const auto of = [&](std::string_view key) { return number(object, key).value_or(0.0); };
  return {.x_mm = number(object, "x_mm").value_or(of("x1_mm")),
          .y_mm = number(object, "y_mm").value_or(of("y1_mm")),
          .to_x_mm = of("x2_mm"),
          .to_y_mm = of("y2_mm"),
          .width_mm = of("width_mm"),
          .height_mm = of("height_mm"),
          .radius_mm = of("radius_mm"),
          .heading_deg = of("heading_deg")};
}

std::vector<WorldItem> items(const Json& world, std::string_view key) {
  std::vector<WorldItem> result;
  const Json* const list = member(world, key);
  if (list == nullptr) return result;
  if (list->is_object()) result.push_back(item_of(*list));
  if (list->is_array()) {
    for (const Json& one : *list) result.push_back(item_of(one));
  }
  return result;
}

}  // namespace

std::optional<FeedMessage> read_feed_message(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  const auto type = text(json, "type");
  if (!type) return std::nullopt;
  FeedMessage message{.type = *type};
  message.time_s = number(json, "time_s");
  message.unix_time_s = number(json, "unix_time_s");
  if (*type == "state" || *type == "truth") message.pose = pose_of(json);
  if (*type == "event" || *type == "status") {
    message.text = text(json, "text").value_or("");
    message.what = text(json, *type == "event" ? "what" : "stage").value_or("");
  }
  if (*type == "holder") message.name = text(json, "name");
  if (*type == "answer") message.answer = answer_of(json);
  return message;
}

World read_world(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  return {.walls = items(json, "walls"),
          .boxes = items(json, "boxes"),
          .posts = items(json, "posts"),
          .cliffs = items(json, "cliffs"),
          .virtual_walls = items(json, "virtual_walls"),
          .home_bases = items(json, "home_base")};
}

std::vector<Constant> read_constants(std::string_view line) {
  std::vector<Constant> constants;
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return constants;
  for (const auto& [key, value] : json.items()) {
    if (key != "type" && key != "seq" && value.is_primitive() && !value.is_null())
      constants.push_back({.name = key, .json = value.dump()});
  }
  return constants;
}

}  // namespace cargobay::web
