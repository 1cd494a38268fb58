#include "hal/cli/drive/drive_events.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/columns/records.hpp"

namespace cargobay::cli {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kTicksAround = 8;

// What shows how it came to an event.
bool tells_how(const std::string& path) {
  constexpr auto kTelling = std::to_array<std::string_view>(
      {"tick", "mode", "hazards", "set_mm_s", "estimate_mm_s", "command_mm_s"});
  return std::ranges::find(kTelling, path.substr(0, path.find('.'))) != kTelling.end();
}

std::string around_json(const hal::CycleState& state) {
  const hal::StateRecord record{.state = state};
  std::string out{"{"};
  hal::MemberWriter members{out};
  for (const auto& column : hal::state_columns()) {
    if (tells_how(column.path)) members.put(column.path, column.value(record));
  }
  members.end();
  return out += '}';
}

Json states_around(std::int64_t tick, const std::vector<hal::CycleState>& states) {
  Json around = Json::array();
  auto state = std::lower_bound(
      states.begin(), states.end(), tick - kTicksAround,
      [](const hal::CycleState& each, std::int64_t first) { return each.tick < first; });
  for (; state != states.end() && state->tick <= tick + kTicksAround; ++state) {
    around.push_back(Json::parse(around_json(*state)));
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
    std::string members;
    hal::append_json(members, hal::event_columns(), hal::EventRecord{.event = event});
    Json out = Json::parse(members);
    if (event.what != hal::EventKind::frames_lost)
      out["states"] = states_around(event.tick, states);
    list.push_back(std::move(out));
  }
  return list.dump();
}

}  // namespace cargobay::cli
