#include "hal/cli/drive/drive_events.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/feed/message/event_json.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kTicksAround = 8;

Json states_around(std::int64_t tick, const std::vector<hal::CycleState>& states) {
  Json around = Json::array();
  auto state = std::lower_bound(
      states.begin(), states.end(), tick - kTicksAround,
      [](const hal::CycleState& each, std::int64_t first) { return each.tick < first; });
  for (; state != states.end() && state->tick <= tick + kTicksAround; ++state) {
    around.push_back({{"tick", state->tick},
                      {"mode", oi::name(state->mode)},
                      {"hazards", Json::parse(hal::json_of(state->hazards))},
                      {"set_mm_s", Json::parse(hal::json_of(state->set).take())},
                      {"estimate_mm_s", Json::parse(hal::json_of(state->estimate).take())},
                      {"command_mm_s", Json::parse(hal::json_of(state->command).take())}});
  }
  return around;
}

}  // namespace

std::string line(const hal::Event& event) {
  return fmt::format("{:8.3f} s  {}\n", hal::robot_time_s(event.tick), hal::describe(event));
}

std::string json(std::span<const hal::Event> events, const std::vector<hal::CycleState>& states) {
  Json list = Json::array();
  for (const hal::Event& event : events) {
    hal::JsonObject object;
    hal::put_event(object, event);
    Json out = Json::parse(object.take());
    if (event.what != hal::EventKind::frames_lost)
      out["states"] = states_around(event.tick, states);
    list.push_back(std::move(out));
  }
  return list.dump();
}

}  // namespace cargobay::cli
