#include "hal/sensing/events.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>

#include "hal/port/port_users.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {
namespace {

struct HazardWords {
  Hazard hazard;
  std::string_view name;
  std::string_view words;
};
constexpr std::array kHazardWords{
    HazardWords{Hazard::wheel_drop_left, oi::name(oi::Bump::wheel_drop_left),
                "the left wheel is off the floor"},
    HazardWords{Hazard::wheel_drop_right, oi::name(oi::Bump::wheel_drop_right),
                "the right wheel is off the floor"},
    HazardWords{Hazard::wheel_drop_front, oi::name(oi::Bump::wheel_drop_front),
                "the front wheel is off the floor"},
    HazardWords{Hazard::cliff_left, oi::kCreate.packet(oi::PacketId::cliff_left).key,
                "a cliff on the left"},
    HazardWords{Hazard::cliff_front_left, oi::kCreate.packet(oi::PacketId::cliff_front_left).key,
                "a cliff at the front left"},
    HazardWords{Hazard::cliff_front_right, oi::kCreate.packet(oi::PacketId::cliff_front_right).key,
                "a cliff at the front right"},
    HazardWords{Hazard::cliff_right, oi::kCreate.packet(oi::PacketId::cliff_right).key,
                "a cliff on the right"},
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
  if (!bumps.has(oi::Bump::bump_left)) return "on the right";
  return bumps.has(oi::Bump::bump_right) ? "in front" : "on the left";
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

std::string describe_user(const Event& event) {
  if (event.process == 0) {
    return "another process opens the port now and then, too briefly to be named, and may take "
           "bytes from it: look for scripts and services that read it (auditctl -w PORT -p r "
           "records each)";
  }
  const PortUser user{.id = event.process, .name = event.process_name.data()};
  if (kill(user.id, 0) != 0 && errno == ESRCH) {
    return describe(user) +
           " opened the port for a moment and may have taken bytes from it: find "
           "out what starts it, a script or a service, and end that";
  }
  return describe(user) + " also has the port open and may take bytes from it: " + remedy(user);
}

using Finding = rt::WheelWatch::Finding;

struct FindingWords {
  std::string_view name;
  std::string_view one;   // wheel: "the left wheel ..."
  std::string_view both;  // "both wheels ..."
};
// In the order of Finding.
constexpr std::array kFindingWords{
    FindingWords{"nothing", "", ""},
    FindingWords{"still", "is driven but counts nothing: its counter is dead, or it is stuck",
                 "are driven but count nothing: their counters are dead, or they are stuck"},
    FindingWords{"reversed", "counts against the direction in which it is driven",
                 "count against the direction in which they are driven"},
    FindingWords{"few", "counts much less than the other for the same command",
                 "count much less than they must"},
    FindingWords{"jumps", "", "say again and again that they went further than any robot can"},
};
constexpr const FindingWords& words(Finding finding) {
  return kFindingWords[static_cast<std::size_t>(finding)];
}
static_assert(words(Finding::jumps).name == "jumps" && words(Finding::few).name == "few");

bool both(oi::BitSet<Wheel> wheels) { return wheels.has(Wheel::left) && wheels.has(Wheel::right); }

std::string describe(oi::BitSet<Wheel> wheels) {
  if (both(wheels)) return "both wheels";
  return wheels.has(Wheel::left) ? "the left wheel" : "the right wheel";
}

std::string describe(const rt::WheelSpeeds& speeds) {
  std::array<char, 40> text{};
  (void)std::snprintf(text.data(), text.size(), "%.0f and %.0f", speeds.left_mm_s,  // fits
                      speeds.right_mm_s);
  return text.data();
}

std::string driven_and_counted(const Event& event) {
  if (event.finding == Finding::jumps) return "";
  return " (left and right: driven at " + describe(event.wanted) + " mm/s, counted " +
         describe(event.got) + ")";
}

std::string describe_stuck(const Event& event) {
  return describe(event.wheels) + (both(event.wheels) ? " draw" : " draws") +
         " too much current and " + (both(event.wheels) ? "do" : "does") + " not turn" +
         driven_and_counted(event);
}

std::string describe_implausible(const Event& event) {
  const FindingWords& found = words(event.finding);
  return describe(event.wheels) + " " + std::string{both(event.wheels) ? found.both : found.one} +
         driven_and_counted(event);
}

std::string describe_limits(const Event& event) {
  const std::string_view what = event.limits.has(Limit::speed)
                                    ? "the wheels cannot turn as fast as asked for"
                                    : "the limit of acceleration holds the wheels back";
  return std::string{what} + ": " + describe(event.got) + " mm/s instead of " +
         describe(event.wanted);
}

struct EventRow {
  EventKind kind;
  std::string_view name;
  Payload payload;
  std::string (*words)(const Event& event);
};
constexpr std::array<EventRow, kEventKinds> kEvents{{
    {EventKind::mode_lost, "mode_lost", Payload::mode,
     [](const Event& event) {
       return "the robot went to " + std::string{oi::name(event.mode)} + " mode by itself" +
              because(event.hazards);
     }},
    {EventKind::rearmed, "rearmed", Payload::nothing,
     [](const Event&) -> std::string { return "the robot is armed again"; }},
    {EventKind::rearm_failed, "rearm_failed", Payload::mode,
     [](const Event& event) {
       return "the robot stays in " + std::string{oi::name(event.mode)} + " mode" +
              because(event.hazards);
     }},
    {EventKind::battery_low, "battery_low", Payload::battery,
     [](const Event& event) { return "the battery is low: " + describe(event.battery); }},
    {EventKind::battery_recovered, "battery_recovered", Payload::battery,
     [](const Event& event) { return "the battery has recovered: " + describe(event.battery); }},
    {EventKind::overcurrent_began, "overcurrent_began", Payload::overcurrents,
     [](const Event& event) { return describe(event.overcurrents) + " draws too much current"; }},
    {EventKind::overcurrent_ended, "overcurrent_ended", Payload::nothing,
     [](const Event&) -> std::string { return "nothing draws too much current now"; }},
    {EventKind::charging_began, "charging_began", Payload::battery,
     [](const Event& event) { return "the battery is charging: " + describe(event.battery); }},
    {EventKind::charging_ended, "charging_ended", Payload::battery,
     [](const Event&) -> std::string { return "the battery is no longer charging"; }},
    {EventKind::frames_lost, "frames_lost", Payload::frames,
     [](const Event& event) {
       return std::to_string(event.frames) + (event.frames == 1 ? " frame" : " frames") + " lost";
     }},
    {EventKind::silence_began, "silence_began", Payload::nothing,
     [](const Event&) -> std::string {
       return "the robot is silent; the wheels were told to stop";
     }},
    {EventKind::silence_ended, "silence_ended", Payload::nothing,
     [](const Event&) -> std::string { return "the robot is heard again"; }},
    {EventKind::setpoint_lapsed, "setpoint_lapsed", Payload::nothing,
     [](const Event&) -> std::string { return "the setpoint was not renewed; the wheels stop"; }},
    {EventKind::control_refused, "control_refused", Payload::nothing,
     [](const Event&) -> std::string {
       return "the control function asked for speeds that the robot cannot do; the wheels stop";
     }},
    {EventKind::bump_began, "bump_began", Payload::bumps,
     [](const Event& event) { return "the robot bumped into something " + describe(event.bumps); }},
    {EventKind::bump_ended, "bump_ended", Payload::nothing,
     [](const Event&) -> std::string { return "nothing touches the bumper now"; }},
    {EventKind::port_shared, "port_shared", Payload::process, &describe_user},
    {EventKind::wheel_stuck, "wheel_stuck", Payload::wheels, &describe_stuck},
    {EventKind::counters_implausible, "counters_implausible", Payload::wheels,
     &describe_implausible},
    {EventKind::limit_began, "limit_began", Payload::limits, &describe_limits},
    {EventKind::limit_ended, "limit_ended", Payload::limits,
     [](const Event&) -> std::string { return "the wheels do what is asked for"; }},
}};
static_assert([] {
  for (std::size_t i = 0; i < kEventKinds; ++i) {
    if (static_cast<std::size_t>(kEvents[i].kind) != i || kEvents[i].name.empty()) return false;
  }
  return true;
}());

const EventRow& row(EventKind what) { return kEvents[static_cast<std::size_t>(what)]; }

}  // namespace

Bumps bumps_in(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  constexpr auto kBoth = Bumps{}.with(oi::Bump::bump_left).with(oi::Bump::bump_right);
  return frame.bumps_and_wheel_drops() & kBoth;
}

Hazards hazards_in(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  using Drop = oi::Bump;
  const auto drops = frame.bumps_and_wheel_drops();  // packets that the frame does not have read 0
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

std::string_view name(Hazard hazard) {
  for (const HazardWords& each : kHazardWords) {
    if (each.hazard == hazard) return each.name;
  }
  return "";
}

std::string_view name(Limit limit) { return limit == Limit::speed ? "speed" : "acceleration"; }
std::string_view name(Wheel wheel) { return wheel == Wheel::left ? "left" : "right"; }
std::string_view name(rt::WheelWatch::Finding finding) { return words(finding).name; }

std::string describe(Hazards hazards) {
  std::string words;
  for (const HazardWords& each : kHazardWords) {
    if (hazards.has(each.hazard)) join(words, each.words);
  }
  return words;
}

std::string_view name(EventKind what) { return row(what).name; }
Payload payload(EventKind what) { return row(what).payload; }
std::string describe(const Event& event) { return row(event.what).words(event); }

}  // namespace cargobay::hal
