#include "hal/feed/message/reading.hpp"

#include <numbers>
#include <type_traits>

#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using Json = nlohmann::json;

const Json* member(const Json& object, std::string_view key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

// Takes the member's value if it is there and of that kind.
template <typename Wanted>
bool take(const Json& object, std::string_view key, Wanted& into) {
  const Json* const found = member(object, key);
  if (found == nullptr) return false;
  bool fits = false;
  if constexpr (std::is_same_v<Wanted, std::string>) {
    fits = found->is_string();
  } else if constexpr (std::is_same_v<Wanted, bool>) {
    fits = found->is_boolean();
  } else {
    fits = std::is_integral_v<Wanted> ? found->is_number_integer() : found->is_number();
  }
  if (fits) into = found->get<Wanted>();
  return fits;
}

template <typename Wanted>
std::optional<Wanted> taken(const Json& object, std::string_view key) {
  Wanted value{};
  if (!take(object, key, value)) return std::nullopt;
  return value;
}

// The value if it is of the column's kind; words live as long as the JSON.
Value value_of(const Json& json, ColumnInfo::Kind kind) {
  using Kind = ColumnInfo::Kind;
  switch (kind) {
    case Kind::truth: return json.is_boolean() ? Value{json.get<bool>()} : Value{};
    case Kind::whole: return json.is_number_integer() ? Value{json.get<std::int64_t>()} : Value{};
    case Kind::number: return json.is_number() ? Value{json.get<double>()} : Value{};
    case Kind::text: return json.is_string() ? Value{json.get<std::string>()} : Value{};
    case Kind::words: break;
  }
  if (!json.is_array()) return {};
  std::vector<std::string_view> words;
  for (const Json& word : json) {
    if (word.is_string()) words.emplace_back(word.get_ref<const std::string&>());
  }
  return words;
}

template <typename Record>
Record record_of(const Json& message, const Columns<Record>& columns) {
  Record record;
  for (const Column<Record>& column : columns) {
    if (!column.take) continue;
    const std::size_t dot = column.path.find('.');
    const Json* found = member(message, column.path.substr(0, dot));
    if (found != nullptr && dot != std::string::npos)
      found = member(*found, column.path.substr(dot + 1));
    if (found == nullptr) continue;
    if (const Value value = value_of(*found, column.kind); known(value)) column.take(record, value);
  }
  return record;
}

heard::Hello hello_of(const Json& message) {
  heard::Hello hello;
  take(message, "program", hello.program);
  take(message, "port", hello.port);
  take(message, "robot", hello.robot);
  take(message, "pid", hello.process);
  take(message, "baud", hello.baud);
  take(message, "steerable", hello.steerable);
  take(message, "max_speed_mm_s", hello.max_speed_mm_s);
  for (const auto& [key, value] : message.items()) {
    if (key != "type" && key != "seq" && value.is_primitive() && !value.is_null())
      hello.constants.emplace_back(key, value.dump());
  }
  return hello;
}

heard::Status status_of(const Json& message) {
  return {.stage = taken<std::string>(message, "stage"),
          .text = taken<std::string>(message, "text").value_or("")};
}

heard::Sensors sensors_of(const Json& message) {
  heard::Sensors sensors{.record = record_of(message, sensor_columns())};
  take(message, "tick", sensors.tick);
  return sensors;
}

heard::Event event_of(const Json& message) {
  heard::Event event;
  take(message, "what", event.what);
  take(message, "text", event.text);
  take(message, "robot_time_s", event.robot_time_s);
  return event;
}

std::optional<heard::Durations> durations(const Json& message, std::string_view key) {
  const Json* const found = member(message, key);
  if (found == nullptr) return std::nullopt;
  heard::Durations out;
  take(*found, "count", out.count);
  take(*found, "p50", out.p50_ns);
  take(*found, "p99", out.p99_ns);
  take(*found, "max", out.max_ns);
  const Json* const pairs = member(*found, "histogram");
  if (pairs == nullptr || !pairs->is_array()) return out;
  for (const Json& pair : *pairs) {
    if (pair.is_array() && pair.size() == 2 && pair[0].is_number() && pair[1].is_number_integer())
      out.histogram.emplace_back(pair[0].get<double>(), pair[1].get<std::uint64_t>());
  }
  return out;
}

heard::Statistics statistics_of(const Json& message) {
  heard::Statistics statistics{.period = durations(message, "period_ns"),
                               .frame_to_command = durations(message, "frame_to_command_ns")};
  if (const Json* const frames = member(message, "frames")) {
    take(*frames, "good", statistics.frames.good);
    take(*frames, "bad", statistics.frames.bad);
    take(*frames, "lost", statistics.frames.lost);
    take(*frames, "late", statistics.frames.late);
  }
  take(message, "unsent", statistics.unsent);
  take(message, "clients", statistics.clients);
  return statistics;
}

heard::Truth truth_of(const Json& message) {
  heard::Truth truth;
  if (const Json* const pose = member(message, "pose")) {
    double heading_deg = 0.0;
    take(*pose, "x_mm", truth.pose.x_mm);
    take(*pose, "y_mm", truth.pose.y_mm);
    take(*pose, "heading_deg", heading_deg);
    truth.pose.heading_rad = heading_deg * std::numbers::pi / 180.0;
  }
  if (const Json* const wheels = member(message, "wheel_mm_s")) {
    take(*wheels, "left", truth.wheels.left_mm_s);
    take(*wheels, "right", truth.wheels.right_mm_s);
  }
  return truth;
}

heard::WorldItem item_of(const Json& object) {
  heard::WorldItem item;
  if (!take(object, "x_mm", item.x_mm)) take(object, "x1_mm", item.x_mm);
  if (!take(object, "y_mm", item.y_mm)) take(object, "y1_mm", item.y_mm);
  take(object, "x2_mm", item.to_x_mm);
  take(object, "y2_mm", item.to_y_mm);
  take(object, "width_mm", item.width_mm);
  take(object, "height_mm", item.height_mm);
  take(object, "radius_mm", item.radius_mm);
  take(object, "heading_deg", item.heading_deg);
  return item;
}

std::vector<heard::WorldItem> items(const Json& world, std::string_view key) {
  std::vector<heard::WorldItem> result;
  const Json* const list = member(world, key);
  if (list == nullptr) return result;
  if (list->is_object()) result.push_back(item_of(*list));
  if (list->is_array()) {
    for (const Json& one : *list) result.push_back(item_of(one));
  }
  return result;
}

heard::World world_of(const Json& message) {
  return {.walls = items(message, "walls"),
          .boxes = items(message, "boxes"),
          .posts = items(message, "posts"),
          .cliffs = items(message, "cliffs"),
          .virtual_walls = items(message, "virtual_walls"),
          .home_bases = items(message, "home_base")};
}

heard::Missed missed_of(const Json& message) {
  return {.messages = taken<std::uint64_t>(message, "messages").value_or(0)};
}

heard::Answer answer_of(const Json& message) {
  const Json* const id = member(message, "id");
  heard::Answer answer{.id = id == nullptr ? "null" : id->dump()};
  take(message, "ok", answer.ok);
  take(message, "error", answer.error);
  const Json* const result = member(message, "result");
  if (result != nullptr) take(*result, "lease", answer.lease);
  return answer;
}

heard::Holder holder_of(const Json& message) {
  heard::Holder holder{.name = taken<std::string>(message, "name")};
  take(message, "lease", holder.lease);
  return holder;
}

}  // namespace

std::optional<HeardMessage> read_message(std::string_view line) {
  const Json message = Json::parse(line, nullptr, false);
  const auto name = taken<std::string>(message, "type");
  const auto type = name ? feed_type(*name) : std::nullopt;
  if (!type) return std::nullopt;
  HeardMessage heard{.type = *type,
                     .unix_ns = unix_ns(taken<double>(message, "unix_time_s").value_or(0.0))};
  switch (*type) {
    case FeedType::hello: heard.what = hello_of(message); break;
    case FeedType::status: heard.what = status_of(message); break;
    case FeedType::state: heard.what = record_of(message, state_columns()); break;
    case FeedType::sensors: heard.what = sensors_of(message); break;
    case FeedType::event: heard.what = event_of(message); break;
    case FeedType::statistics: heard.what = statistics_of(message); break;
    case FeedType::truth: heard.what = truth_of(message); break;
    case FeedType::world: heard.what = world_of(message); break;
    case FeedType::holder: heard.what = holder_of(message); break;
    case FeedType::missed: heard.what = missed_of(message); break;
    case FeedType::answer: heard.what = answer_of(message); break;
    case FeedType::virtual_create:
    case FeedType::controls: break;
  }
  return heard;
}

}  // namespace cargobay::hal
