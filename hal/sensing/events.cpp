#include "hal/sensing/events.hpp"

#include <array>
#include <cstdio>

#include "hal/port/port_users.hpp"

namespace cargobay::hal {
namespace {

struct HazardWords {
  Hazard hazard;
  std::string_view name;
  std::string_view words;
};
constexpr std::array kHazardWords{
    HazardWords{Hazard::wheel_drop_left, "wheel_drop_left", "the left wheel hangs in the air"},
    HazardWords{Hazard::wheel_drop_right, "wheel_drop_right", "the right wheel hangs in the air"},
    HazardWords{Hazard::wheel_drop_front, "wheel_drop_front", "the front wheel hangs in the air"},
    HazardWords{Hazard::cliff_left, "cliff_left", "a cliff at the left"},
    HazardWords{Hazard::cliff_front_left, "cliff_front_left", "a cliff at the front left"},
    HazardWords{Hazard::cliff_front_right, "cliff_front_right", "a cliff at the front right"},
    HazardWords{Hazard::cliff_right, "cliff_right", "a cliff at the right"},
    HazardWords{Hazard::charger, "charger", "the charger is plugged in"},
};

struct OvercurrentWords {
  oi::Overcurrent overcurrent;
  std::string_view words;
};
constexpr std::array kOvercurrentWords{
    OvercurrentWords{oi::Overcurrent::left_wheel, "the left wheel"},
    OvercurrentWords{oi::Overcurrent::right_wheel, "the right wheel"},
    OvercurrentWords{oi::Overcurrent::low_side_driver_0, "low side driver 0"},
    OvercurrentWords{oi::Overcurrent::low_side_driver_1, "low side driver 1"},
    OvercurrentWords{oi::Overcurrent::low_side_driver_2, "low side driver 2"},
};

void join(std::string& sentence, std::string_view part) {
  if (!sentence.empty()) sentence += " and ";
  sentence += part;
}

std::string describe(oi::BitSet<oi::Overcurrent> overcurrents) {
  std::string words;
  for (const OvercurrentWords& each : kOvercurrentWords) {
    if (overcurrents.has(each.overcurrent)) join(words, each.words);
  }
  return words;
}

std::string describe(Bumps bumps) {
  if (!bumps.has(oi::Bump::bump_left)) return "at the right";
  return bumps.has(oi::Bump::bump_right) ? "in front" : "at the left";
}

std::string describe(const BatteryState& battery) {
  std::array<char, 80> text{};
  if (battery.capacity_mah > 0) {
    (void)std::snprintf(text.data(), text.size(), "%.1f V, %d of %d mAh",  // cut short at worst
                        battery.voltage_mv / 1e3, battery.charge_mah, battery.capacity_mah);
  } else {
    (void)std::snprintf(text.data(), text.size(), "%.1f V", battery.voltage_mv / 1e3);
  }
  return text.data();
}

std::string because(Hazards hazards) {
  return hazards.any() ? ": " + describe(hazards) : ", and no sensor says why";
}

}  // namespace

Bumps bumps_in(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  constexpr auto kBoth = Bumps{}.with(oi::Bump::bump_left).with(oi::Bump::bump_right);
  return Bumps{static_cast<std::uint8_t>(frame.bumps_and_wheel_drops().raw() & kBoth.raw())};
}

Hazards hazards_in(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  using Drop = oi::Bump;
  const auto drops = frame.bumps_and_wheel_drops();  // what the frame has not got reads 0
  Hazards found;
  if (drops.has(Drop::wheel_drop_left)) found = found.with(Hazard::wheel_drop_left);
  if (drops.has(Drop::wheel_drop_right)) found = found.with(Hazard::wheel_drop_right);
  if (drops.has(Drop::wheel_drop_front)) found = found.with(Hazard::wheel_drop_front);
  if (frame.cliff_left()) found = found.with(Hazard::cliff_left);
  if (frame.cliff_front_left()) found = found.with(Hazard::cliff_front_left);
  if (frame.cliff_front_right()) found = found.with(Hazard::cliff_front_right);
  if (frame.cliff_right()) found = found.with(Hazard::cliff_right);
  if (frame.charging_sources().any()) found = found.with(Hazard::charger);
  return found;
}

std::string_view name(EventKind what) {
  switch (what) {
    case EventKind::mode_lost: return "mode_lost";
    case EventKind::rearmed: return "rearmed";
    case EventKind::rearm_failed: return "rearm_failed";
    case EventKind::battery_low: return "battery_low";
    case EventKind::battery_recovered: return "battery_recovered";
    case EventKind::overcurrent_began: return "overcurrent_began";
    case EventKind::overcurrent_ended: return "overcurrent_ended";
    case EventKind::charging_began: return "charging_began";
    case EventKind::charging_ended: return "charging_ended";
    case EventKind::frames_lost: return "frames_lost";
    case EventKind::silence_began: return "silence_began";
    case EventKind::silence_ended: return "silence_ended";
    case EventKind::setpoint_lapsed: return "setpoint_lapsed";
    case EventKind::control_refused: return "control_refused";
    case EventKind::bump_began: return "bump_began";
    case EventKind::bump_ended: return "bump_ended";
    case EventKind::port_shared: return "port_shared";
  }
  return "";
}

std::string_view name(Hazard hazard) {
  for (const HazardWords& each : kHazardWords) {
    if (each.hazard == hazard) return each.name;
  }
  return "";
}

std::string describe(Hazards hazards) {
  std::string words;
  for (const HazardWords& each : kHazardWords) {
    if (hazards.has(each.hazard)) join(words, each.words);
  }
  return words;
}

std::string describe(const Event& event) {
  switch (event.what) {
    case EventKind::mode_lost:
      return "the robot went to " + std::string{oi::name(event.mode)} + " mode by itself" +
             because(event.hazards);
    case EventKind::rearmed: return "the robot is armed again";
    case EventKind::rearm_failed:
      return "the robot stays in " + std::string{oi::name(event.mode)} + " mode" +
             because(event.hazards);
    case EventKind::battery_low: return "the battery is low: " + describe(event.battery);
    case EventKind::battery_recovered:
      return "the battery has recovered: " + describe(event.battery);
    case EventKind::overcurrent_began: return describe(event.overcurrents) + " draws too much";
    case EventKind::overcurrent_ended: return "nothing draws too much any more";
    case EventKind::charging_began: return "the battery is charged: " + describe(event.battery);
    case EventKind::charging_ended: return "the battery is no longer charged";
    case EventKind::frames_lost:
      return std::to_string(event.frames) + (event.frames == 1 ? " frame" : " frames") + " lost";
    case EventKind::silence_began: return "the robot is silent; the wheels were told to stop";
    case EventKind::silence_ended: return "the robot is heard again";
    case EventKind::setpoint_lapsed: return "the setpoint was not renewed; the wheels stop";
    case EventKind::control_refused:
      return "the control function asked for speeds that no robot can do; the wheels stop";
    case EventKind::bump_began: return "the robot bumped into something " + describe(event.bumps);
    case EventKind::bump_ended: return "nothing touches the bumper any more";
    case EventKind::port_shared: {
      const PortUser user{.id = event.process, .name = event.process_name.data()};
      return describe(user) + " has the port open too and may take bytes from it: " + remedy(user);
    }
  }
  return "";
}

}  // namespace cargobay::hal
