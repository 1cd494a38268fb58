// Events of the robot that its program, or a person beside it, may want to know about: plain data,
// through a ring from the control thread to one other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "oi/bit_set.hpp"
#include "oi/command_table.hpp"
#include "oi/sensors.hpp"
#include "rt/clock.hpp"
#include "rt/ring.hpp"
#include "rt/wheel_speeds.hpp"
#include "rt/wheel_watch.hpp"

namespace cargobay::hal {

// What makes Safe mode stop the robot and become Passive (OI p. 6).
enum class Hazard : std::uint8_t {
  wheel_drop_left,
  wheel_drop_right,
  wheel_drop_front,
  cliff_left,
  cliff_front_left,
  cliff_front_right,
  cliff_right,
  charger,
};
using Hazards = oi::BitSet<Hazard>;

// What a frame says about them; none if it has no packet that would.
Hazards hazards_in(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;

// The bumper's two sides.
using Bumps = oi::BitSet<oi::Bump>;
// None if the frame has no packet that would show them.
Bumps bumps_in(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;

// What keeps the wheels from the speeds that were asked for.
enum class Limit : std::uint8_t {
  speed,         // beyond what the weaker wheel can reach, or may be driven at
  acceleration,  // the set speeds are on their way
};
using Limits = oi::BitSet<Limit>;

enum class Wheel : std::uint8_t { left, right };

// Each has its row in events.cpp: name, payload, words.
enum class EventKind : std::uint8_t {
  mode_lost,     // by itself, the robot left the mode it was driven in
  rearmed,       // it is back in that mode, as requested
  rearm_failed,  // it was told to go back, and did not
  battery_low,
  battery_recovered,
  overcurrent_began,  // `overcurrents`: those that were not there before
  overcurrent_ended,  // the last of them is gone
  charging_began,
  charging_ended,
  frames_lost,           // damaged, or never came
  silence_began,         // no frame for stop_after: the wheels were told to stop
  silence_ended,         // a frame came
  setpoint_lapsed,       // it was not renewed: the wheels stop until it is
  control_refused,       // the control function asked for speeds that are not numbers or beyond the
                         // robot's range: the wheels stop until it asks for others
  bump_began,            // `bumps`: those that were not there before
  bump_ended,            // the last of them is gone
  port_shared,           // another process has the port open too, and frames go missing
  wheel_stuck,           // `wheels` draw too much current and do not turn
  counters_implausible,  // distance and angle cannot be true of a robot that is driven like this
  limit_began,           // both wheels are held back by one factor, see hal/sensing/limit_watch.hpp
  limit_ended,           // they do what is asked for
};
inline constexpr std::size_t kEventKinds = static_cast<std::size_t>(EventKind::limit_ended) + 1;

// Which members of Event say more than its kind.
enum class Payload : std::uint8_t {
  nothing,
  mode,  // `mode`, and `hazards`: the causes, none if none was seen
  battery,
  overcurrents,
  frames,
  bumps,
  process,  // `process`, `process_name`
  wheels,   // `wheels`, `finding`, `overcurrents`, `wanted` and `got`
  limits,   // `limits`, `wanted` and `got`
};

struct BatteryState {
  std::int32_t voltage_mv = 0;
  std::int32_t charge_mah = 0;
  std::int32_t capacity_mah = 0;
  oi::ChargingState charging = oi::ChargingState::not_charging;
};

struct Event {
  EventKind what = EventKind::mode_lost;
  std::int64_t tick = 0;  // of the robot, as in CycleState: the newest frame when it was noticed
  rt::TimePoint time{};   // on the stream's clock
  // Set as far as payload() says for the kind.
  oi::Mode mode = oi::Mode::off;
  Hazards hazards{};
  oi::BitSet<oi::Overcurrent> overcurrents{};
  BatteryState battery{};
  std::uint32_t frames = 0;
  Bumps bumps{};
  std::int32_t process = 0;
  std::array<char, 16> process_name{};  // as the kernel stores it, 0-terminated
  oi::BitSet<Wheel> wheels{};
  rt::WheelWatch::Finding finding = rt::WheelWatch::Finding::nothing;
  Limits limits{};
  // Of limits: asked for, and given. Of wheels: what a wheel that reaches its command would have
  // done, and what was counted, both in the direction in which it is driven.
  rt::WheelSpeeds wanted{};
  rt::WheelSpeeds got{};
};

// An event that finds the ring full is dropped and counted.
inline constexpr std::size_t kMostEvents = 256;
using EventRing = rt::SpscRing<Event, kMostEvents>;

// The name used by programs: "mode_lost".
std::string_view name(EventKind what);
std::string_view name(Hazard hazard);
std::string_view name(Limit limit);
std::string_view name(Wheel wheel);
std::string_view name(rt::WheelWatch::Finding finding);
Payload payload(EventKind what);

// In words, one line without the time: "the robot went from its mode to passive: a cliff at the
// front left". Allocates; for port_shared it looks at the process to say what to do about it.
std::string describe(const Event& event);
// "the left wheel hangs in the air and a cliff at the left"; empty if there is none. Allocates.
std::string describe(Hazards hazards);

}  // namespace cargobay::hal
