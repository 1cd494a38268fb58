#include "hal/cli/drive/drive_events.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "oi/limits.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kTicksAround = 8;

double robot_time_s(std::int64_t tick) {
  return static_cast<double>(tick) * rt::seconds(oi::kTick);
}

constexpr unsigned kBits = 8;  // of a bit set

Json names(hal::Hazards hazards) {
  Json names = Json::array();
  for (unsigned bit = 0; bit < kBits; ++bit) {
    const auto hazard = static_cast<hal::Hazard>(bit);
    if (hazards.has(hazard)) names.push_back(hal::name(hazard));
  }
  return names;
}

// The names of the bits that are set in a packet's byte.
Json names(oi::PacketId packet, std::uint8_t bits) {
  Json names = Json::array();
  for (unsigned bit = 0; bit < kBits; ++bit) {
    if (((bits >> bit) & 1U) != 0) names.push_back(oi::bit_name(packet, bit));
  }
  return names;
}

// Of a set with two members.
template <typename Bit>
Json names_of(oi::BitSet<Bit> set) {
  Json names = Json::array();
  for (const Bit bit : {Bit{0}, Bit{1}}) {
    if (set.has(bit)) names.push_back(hal::name(bit));
  }
  return names;
}

Json wheels(const rt::WheelSpeeds& speeds) {
  return {{"left", speeds.left_mm_s}, {"right", speeds.right_mm_s}};
}

Json states_around(std::int64_t tick, const std::vector<hal::CycleState>& states) {
  Json around = Json::array();
  auto state = std::lower_bound(
      states.begin(), states.end(), tick - kTicksAround,
      [](const hal::CycleState& each, std::int64_t first) { return each.tick < first; });
  for (; state != states.end() && state->tick <= tick + kTicksAround; ++state) {
    around.push_back({{"tick", state->tick},
                      {"mode", oi::name(state->mode)},
                      {"hazards", names(state->hazards)},
                      {"set_mm_s", wheels(state->set)},
                      {"estimate_mm_s", wheels(state->estimate)},
                      {"command_mm_s", wheels(state->command)}});
  }
  return around;
}

// What the event says beyond its kind.
void put_payload(Json& out, const hal::Event& event) {
  using hal::Payload;
  switch (hal::payload(event.what)) {
    case Payload::nothing: break;
    case Payload::mode:
      out["mode"] = oi::name(event.mode);
      out["hazards"] = names(event.hazards);
      break;
    case Payload::battery:
      out["battery"] = {{"mv", event.battery.voltage_mv},
                        {"charge_mah", event.battery.charge_mah},
                        {"capacity_mah", event.battery.capacity_mah}};
      break;
    case Payload::overcurrents:
      out["overcurrents"] = names(oi::PacketId::overcurrents, event.overcurrents.raw());
      break;
    case Payload::frames: out["frames"] = event.frames; break;
    case Payload::bumps:
      out["bumps"] = names(oi::PacketId::bumps_and_wheel_drops, event.bumps.raw());
      break;
    case Payload::wheels:
      out["wheels"] = names_of<hal::Wheel>(event.wheels);
      out["finding"] = hal::name(event.finding);
      out["driven_mm_s"] = wheels(event.wanted);
      out["counted_mm_s"] = wheels(event.got);
      out["overcurrents"] = names(oi::PacketId::overcurrents, event.overcurrents.raw());
      break;
    case Payload::limits:
      out["limits"] = names_of<hal::Limit>(event.limits);
      out["asked_mm_s"] = wheels(event.wanted);
      out["given_mm_s"] = wheels(event.got);
      break;
    case Payload::process:
      out["process"] = {{"id", event.process}, {"name", event.process_name.data()}};
      break;
  }
}

}  // namespace

std::string line(const hal::Event& event) {
  return fmt::format("{:8.3f} s  {}\n", robot_time_s(event.tick), hal::describe(event));
}

std::string json(std::span<const hal::Event> events, const std::vector<hal::CycleState>& states) {
  Json list = Json::array();
  for (const hal::Event& event : events) {
    Json out{{"what", hal::name(event.what)},
             {"tick", event.tick},
             {"time_s", robot_time_s(event.tick)},
             {"text", hal::describe(event)}};
    put_payload(out, event);
    if (event.what != hal::EventKind::frames_lost)
      out["states"] = states_around(event.tick, states);
    list.push_back(std::move(out));
  }
  return list.dump();
}

}  // namespace cargobay::cli
