#include "hal/cli/attached/feed_news.hpp"

#include <numbers>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "oi/dialect.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

using Json = nlohmann::json;

const Json* member(const Json& object, std::string_view key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

// Takes the member's value if it is there and of that kind.
template <typename Number>
void take(const Json& object, std::string_view key, Number& into) {
  const Json* const found = member(object, key);
  if constexpr (std::is_same_v<Number, std::string>) {
    if (found != nullptr && found->is_string()) into = found->get<std::string>();
  } else if constexpr (std::is_same_v<Number, bool>) {
    if (found != nullptr && found->is_boolean()) into = found->get<bool>();
  } else {
    const bool fits = found != nullptr && (std::is_integral_v<Number> ? found->is_number_integer()
                                                                      : found->is_number());
    if (fits) into = found->get<Number>();
  }
}

void take_speeds(const Json& object, std::string_view key, rt::WheelSpeeds& into) {
  const Json* const found = member(object, key);
  if (found == nullptr) return;
  take(*found, "left", into.left_mm_s);
  take(*found, "right", into.right_mm_s);
}

// Of a list of names, those that `name` gives to the flags below `count`.
template <typename Flag, typename Name>
oi::BitSet<Flag> flags(const Json& object, std::string_view key, unsigned count, Name name) {
  oi::BitSet<Flag> set;
  const Json* const list = member(object, key);
  if (list == nullptr || !list->is_array()) return set;
  for (const Json& each : *list) {
    for (unsigned bit = 0; bit < count && each.is_string(); ++bit) {
      const auto flag = static_cast<Flag>(bit);
      if (name(flag) == each.get_ref<const std::string&>()) set = set.with(flag);
    }
  }
  return set;
}

hal::CycleState state_of(const Json& message) {
  hal::CycleState state;
  take(message, "tick", state.tick);
  std::string mode;
  take(message, "mode", mode);
  state.mode = oi::value_named<oi::Mode>(mode).value_or(oi::Mode::off);
  take_speeds(message, "target_mm_s", state.target);
  take_speeds(message, "set_mm_s", state.set);
  take_speeds(message, "estimate_mm_s", state.estimate);
  take_speeds(message, "command_mm_s", state.command);
  take(message, "setpoint_lapsed", state.setpoint_lapsed);
  take(message, "battery_mv", state.battery_mv);
  take(message, "distance_mm", state.distance_mm);
  state.hazards =
      flags<hal::Hazard>(message, "hazards", static_cast<unsigned>(hal::Hazard::charger) + 1,
                         [](hal::Hazard hazard) { return hal::name(hazard); });
  state.limits =
      flags<hal::Limit>(message, "limits", static_cast<unsigned>(hal::Limit::acceleration) + 1,
                        [](hal::Limit limit) { return hal::name(limit); });
  state.bumps = flags<oi::Bump>(message, "bumps", 2, [](oi::Bump bump) { return oi::name(bump); });
  if (const Json* const pose = member(message, "pose")) {
    take(*pose, "x_mm", state.pose.x_mm);
    take(*pose, "y_mm", state.pose.y_mm);
    take(*pose, "heading_rad", state.pose.heading_rad);
  }
  if (const Json* const covariance = member(message, "covariance")) {
    take(*covariance, "xx_mm2", state.pose_covariance.xx);
    take(*covariance, "xy_mm2", state.pose_covariance.xy);
    take(*covariance, "yy_mm2", state.pose_covariance.yy);
    take(*covariance, "xh_mm_rad", state.pose_covariance.xh);
    take(*covariance, "yh_mm_rad", state.pose_covariance.yh);
    take(*covariance, "hh_rad2", state.pose_covariance.hh);
  }
  return state;
}

std::optional<FeedDurations> durations(const Json& message, std::string_view key) {
  const Json* const found = member(message, key);
  if (found == nullptr) return std::nullopt;
  FeedDurations out;
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

void take_hello(const Json& message, FeedHello& hello) {
  take(message, "program", hello.program);
  take(message, "port", hello.port);
  take(message, "robot", hello.robot);
  take(message, "pid", hello.process);
  take(message, "baud", hello.baud);
  take(message, "steerable", hello.steerable);
  take(message, "max_speed_mm_s", hello.max_speed_mm_s);
}

void take_sensors(const Json& message, FeedNews& news) {
  take(message, "tick", news.sensors_tick);
  for (const oi::PacketInfo& packet : oi::kCreate.packets) {
    const Json* const value = packet.is_group() ? nullptr : member(message, packet.key);
    if (value != nullptr && value->is_number_integer())
      news.sensors.set(static_cast<oi::PacketId>(packet.id), value->get<std::int32_t>());
  }
}

void take_event(const Json& message, FeedNews& news) {
  double time_s = 0.0;
  std::string text;
  take(message, "time_s", time_s);
  take(message, "text", text);
  news.events.push_back(fmt::format("{:8.3f} s  {}", time_s, text));
  if (news.events.size() > FeedNews::kMostEvents) news.events.pop_front();
}

void take_statistics(const Json& message, FeedNews& news) {
  if (const Json* const frames = member(message, "frames")) {
    take(*frames, "good", news.frames.good);
    take(*frames, "bad", news.frames.bad);
    take(*frames, "lost", news.frames.lost);
    take(*frames, "late", news.frames.late);
  }
  take(message, "unsent", news.unsent);
  take(message, "clients", news.clients);
  news.period = durations(message, "period_ns");
  news.frame_to_command = durations(message, "frame_to_command_ns");
}

void take_truth(const Json& message, FeedNews& news) {
  FeedTruth truth;
  if (const Json* const pose = member(message, "pose")) {
    double heading_deg = 0.0;
    take(*pose, "x_mm", truth.pose.x_mm);
    take(*pose, "y_mm", truth.pose.y_mm);
    take(*pose, "heading_deg", heading_deg);
    truth.pose.heading_rad = heading_deg * std::numbers::pi / 180.0;
  }
  take_speeds(message, "wheel_mm_s", truth.wheels);
  news.truth = truth;
}

void take_answer(const Json& message, FeedNews& news) {
  news.answer = {};
  const Json* const id = member(message, "id");
  news.answer.id = id == nullptr ? "null" : id->dump();
  take(message, "ok", news.answer.ok);
  take(message, "error", news.answer.error);
}

}  // namespace

std::optional<hal::FeedType> FeedNews::hear(std::string_view line) {
  const Json message = Json::parse(line, nullptr, false);
  std::string type_name;
  take(message, "type", type_name);
  const auto type = hal::feed_type(type_name);
  if (!type) return std::nullopt;
  switch (*type) {
    case hal::FeedType::hello: take_hello(message, hello); break;
    case hal::FeedType::status:
      take(message, "stage", stage);
      take(message, "text", text);
      break;
    case hal::FeedType::state:
      state = state_of(message);
      take(message, "unix_time_s", state_unix_s);
      break;
    case hal::FeedType::sensors: take_sensors(message, *this); break;
    case hal::FeedType::event: take_event(message, *this); break;
    case hal::FeedType::statistics: take_statistics(message, *this); break;
    case hal::FeedType::truth: take_truth(message, *this); break;
    case hal::FeedType::holder:
      holder.clear();
      take(message, "name", holder);
      break;
    case hal::FeedType::missed: {
      std::uint64_t more = 0;
      take(message, "messages", more);
      missed += more;
      break;
    }
    case hal::FeedType::answer: take_answer(message, *this); break;
    case hal::FeedType::virtual_create:
    case hal::FeedType::world:
    case hal::FeedType::controls: break;  // for maps, and hands
  }
  return type;
}

}  // namespace cargobay::cli
