// What each command does (OI p. 7 to 16). A number outside the manual's range is clamped if the
// robot has a sensible nearest value, and ignored if not; either way it is counted.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/sim/robot/device.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/extensions.hpp"
#include "oi/limits.hpp"
#include "oi/parse.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr oi::FirmwareDate kFirmware{.year = 7, .month = 9, .day = 24, .hour = 18, .minute = 35};

// "Create beeps once to acknowledge it is starting from off" (OI p. 7); the manual does not say
// how.
constexpr std::array kStartBeep{oi::Note{84, oi::SixtyFourths{8}}};

constexpr std::uint8_t low_byte(std::int32_t value) { return static_cast<std::uint8_t>(value); }

}  // namespace

void Device::process() {
  // Takes each byte once; Play Script adds the length of a script, once a tick.
  while (!serial_.input.empty() && !waiting() && !replying() && supply_.state == Power::on) {
    const std::uint8_t byte = serial_.input.front();
    serial_.input.pop_front();
    interpret(byte);
  }
}

void Device::interpret(std::uint8_t byte) {
  if (mode_ == oi::Mode::off) {
    // Off does not even assemble commands: it only listens for Start.
    if (byte == oi::Start::kOpcode) {
      serial_.parser.reset();
      ++counters_.commands;
      enter(oi::Mode::passive);
      own_sound_.start(kStartBeep, now_);
    }
    return;
  }
  switch (serial_.parser.push(byte)) {
    case oi::CommandParser::Outcome::incomplete: return;
    case oi::CommandParser::Outcome::unknown_opcode: return extension(byte);
    case oi::CommandParser::Outcome::command:
      return execute(serial_.parser.info(), serial_.parser.bytes());
  }
}

void Device::extension(std::uint8_t opcode) {
  if (parameters_.dialect->has_undocumented_opcodes) {
    if (opcode == oi::kSoftResetOpcode) return reset();
    if (opcode == oi::kFirmwareDateOpcode) {
      reply_.begin_bytes(oi::firmware_date_answer(kFirmware));
      return reply();
    }
  }
  ++counters_.unknown_opcodes;
}

void Device::execute(const oi::CommandInfo& info, std::span<const std::uint8_t> bytes) {
  if (!info.available_in(mode_)) {
    ++counters_.commands_refused;
    return;
  }
  ++counters_.commands;
  if (!within_manual(bytes)) ++counters_.commands_out_of_range;
  std::array<std::int32_t, 4> arguments{};
  std::size_t offset = 1;
  for (std::size_t i = 0; i < info.argument_count; ++i) {
    arguments[i] = oi::number_at(bytes.subspan(offset), info.argument_slots[i]);
    offset += info.argument_slots[i].size;
  }
  obey(info.opcode, arguments, bytes.subspan(offset));
}

bool Device::within_manual(std::span<const std::uint8_t> bytes) const {
  const oi::ParseResult parsed = oi::parse_command(bytes, *parameters_.dialect);
  if (parsed.outcome == oi::ParseResult::Outcome::command) return true;
  // An extension's packet, in a list or alone, is not a mistake of the host's.
  return parsed.error.argument != nullptr && parsed.error.argument->name == "packet" &&
         parameters_.dialect->find_packet(low_byte(parsed.error.value)) != nullptr;
}

void Device::obey(std::uint8_t opcode, std::span<const std::int32_t> arguments,
                  std::span<const std::uint8_t> tail) {
  switch (opcode) {
    case oi::Start::kOpcode: return enter(oi::Mode::passive);
    case oi::Baud::kOpcode: return change_baud(arguments[0]);
    case oi::Control::kOpcode:
    case oi::Safe::kOpcode: return enter(oi::Mode::safe);
    case oi::Full::kOpcode: return enter(oi::Mode::full);
    case oi::Spot::kOpcode:
      return start_demo(static_cast<std::int32_t>(oi::DemoNumber::spot_cover));
    case oi::Cover::kOpcode: return start_demo(static_cast<std::int32_t>(oi::DemoNumber::cover));
    case oi::CoverAndDock::kOpcode:
      return start_demo(static_cast<std::int32_t>(oi::DemoNumber::cover_and_dock));
    case oi::Demo::kOpcode: return start_demo(arguments[0]);
    case oi::Drive::kOpcode: return drive(arguments[0], arguments[1]);
    case oi::DriveDirect::kOpcode: return drive_direct(arguments[0], arguments[1]);
    case oi::LowSideDrivers::kOpcode:
      return actuators_.switch_low_side_drivers(low_byte(arguments[0]));
    case oi::PwmLowSideDrivers::kOpcode:
      return actuators_.set_low_side_drivers(
          {low_byte(arguments[2]), low_byte(arguments[1]), low_byte(arguments[0])});
    case oi::Leds::kOpcode:
      actuators_.leds = {.leds = oi::BitSet<oi::Led>{low_byte(arguments[0])},
                         .power_color = low_byte(arguments[1]),
                         .power_intensity = low_byte(arguments[2])};
      return;
    case oi::DigitalOutputs::kOpcode:
      actuators_.digital_outputs = low_byte(arguments[0] & kAllOutputs);
      return;
    case oi::SendIr::kOpcode: return actuators_.send_infrared(low_byte(arguments[0]));
    case oi::Song::kOpcode: return songs_.store(low_byte(arguments[0]), tail);
    case oi::Play::kOpcode: return songs_.play(low_byte(arguments[0]), now_);
    case oi::Sensors::kOpcode:
      reply_.begin_packets(std::array{low_byte(arguments[0])});
      return reply();
    case oi::QueryList::kOpcode: reply_.begin_packets(tail); return reply();
    case oi::Stream::kOpcode: return stream_.start(tail, *parameters_.dialect);
    case oi::PauseResumeStream::kOpcode:
      return arguments[0] == static_cast<std::int32_t>(oi::StreamState::pause) ? stream_.pause()
                                                                               : stream_.resume();
    case oi::Script::kOpcode: return store_script(tail);
    case oi::PlayScript::kOpcode: return play_script();
    case oi::ShowScript::kOpcode: return show_script();
    case oi::WaitTime::kOpcode: return wait_.for_time(arguments[0], now_);
    case oi::WaitDistance::kOpcode:
      chassis_.odometer.reset_distance();
      return wait_.for_distance(arguments[0]);
    case oi::WaitAngle::kOpcode:
      chassis_.odometer.reset_angle();
      return wait_.for_angle(arguments[0]);
    case oi::WaitEvent::kOpcode: return wait_.for_event(arguments[0]);
    default: return;
  }
}

void Device::enter(oi::Mode mode) {
  const bool controlled = mode_ == oi::Mode::safe || mode_ == oi::Mode::full;
  const bool controls = mode == oi::Mode::safe || mode == oi::Mode::full;
  // On entering Safe or Full, it "waits with all motors and LEDs off"; on leaving them, it stops.
  // Between Safe and Full the wheels keep turning.
  if (controls) actuators_.leds = {};
  if (controls != controlled || demo_.demos.running()) stop_motors();
  demo_.demos.stop();
  demo_.note = 0;
  mode_ = mode;
}

void Device::stop_motors() {
  command_wheels({});
  actuators_.low_side_drivers = {};
}

// The robot hears nothing for 100 ms.
void Device::change_baud(std::int32_t code) {
  if (code < 0 || code >= static_cast<std::int32_t>(parameters_.dialect->baud_rates.size())) return;
  supply_.brc_baud.reset();
  switch_baud(parameters_.dialect->baud_rates[static_cast<std::size_t>(code)]);
  serial_.deaf_until = now_ + oi::kBaudChangeWait;
}

// The new rate applies once everything sent before has left.
void Device::switch_baud(std::uint32_t baud) {
  serial_.next_baud = baud;
  serial_.change_at = std::max(now_, serial_.output.free_at());
}

void Device::take_half_command() {
  if (supply_.state != Power::on) return;
  if (mode_ == oi::Mode::off) enter(oi::Mode::passive);
  serial_.parser.reset();
  // The longest command there is: a song of 255 notes.
  for (const std::uint8_t byte : {oi::Song::kOpcode, std::uint8_t{0}, std::uint8_t{255}}) {
    interpret(byte);
  }
}

void Device::set_baud(std::uint32_t baud) {
  serial_.next_baud = baud;
  serial_.baud = baud;
  serial_.change_at = rt::Duration::max();
}

void Device::drive(std::int32_t velocity_mm_s, std::int32_t radius_mm) {
  const bool straight =
      radius_mm == oi::kStraight.value || radius_mm == oi::kStraightAlternative.value;
  velocity_mm_s = std::clamp(velocity_mm_s, -oi::kMaxWheelSpeed, oi::kMaxWheelSpeed);
  if (!straight) radius_mm = std::clamp(radius_mm, -oi::kMaxRadius, oi::kMaxRadius);
  requested_.velocity_mm_s = velocity_mm_s;
  requested_.radius_mm = radius_mm;
  const auto velocity = static_cast<double>(velocity_mm_s);
  if (straight || radius_mm == 0) return obey_drive({velocity, velocity});
  if (radius_mm == oi::kTurnClockwise.value) return obey_drive({velocity, -velocity});
  if (radius_mm == oi::kTurnCounterClockwise.value) return obey_drive({-velocity, velocity});
  const double half_base_per_radius =
      0.5 * parameters_.wheels.wheel_base_mm / static_cast<double>(radius_mm);
  WheelSpeeds speeds{velocity * (1.0 - half_base_per_radius),
                     velocity * (1.0 + half_base_per_radius)};
  // An arc that is too fast for the outer wheel is driven slower, on the same arc (OI p. 9).
  const double fastest = std::max(std::abs(speeds.left_mm_s), std::abs(speeds.right_mm_s));
  if (fastest > oi::kMaxWheelSpeed) {
    constexpr double kMost = oi::kMaxWheelSpeed;  // rounding must not exceed it
    speeds.left_mm_s = std::clamp(speeds.left_mm_s * kMost / fastest, -kMost, kMost);
    speeds.right_mm_s = std::clamp(speeds.right_mm_s * kMost / fastest, -kMost, kMost);
  }
  obey_drive(speeds);
}

void Device::drive_direct(std::int32_t right_mm_s, std::int32_t left_mm_s) {
  requested_.right_mm_s = std::clamp(right_mm_s, -oi::kMaxWheelSpeed, oi::kMaxWheelSpeed);
  requested_.left_mm_s = std::clamp(left_mm_s, -oi::kMaxWheelSpeed, oi::kMaxWheelSpeed);
  obey_drive(
      {static_cast<double>(requested_.left_mm_s), static_cast<double>(requested_.right_mm_s)});
}

void Device::obey_drive(WheelSpeeds command) {
  command_wheels(command);
  if (on_drive) on_drive({.time = now_, .tick = ticks_, .command = command});
}

void Device::command_wheels(WheelSpeeds command) {
  advance_wheels();
  chassis_.wheels.set_command(command);
}

void Device::start_demo(std::int32_t number) {
  enter(oi::Mode::passive);
  demo_.demos.start(number, demo_view());
}

Demos::View Device::demo_view() const {
  const double mm_per_count = 1.0 / parameters_.wheels.counts_per_mm;
  const double left_mm = static_cast<double>(chassis_.wheels.left().counts()) * mm_per_count;
  const double right_mm = static_cast<double>(chassis_.wheels.right().counts()) * mm_per_count;
  const double turned_rad = (right_mm - left_mm) / parameters_.wheels.wheel_base_mm;
  return {.now = now_,
          .seen = &seen_,
          .travelled_mm = 0.5 * (left_mm + right_mm),
          .turned_deg = turned_rad * 180.0 / std::numbers::pi};
}

void Device::tick_demo() {
  if (!demo_.demos.running()) return;
  const Demos::Action action = demo_.demos.step(demo_view());
  command_wheels(action.wheels);
  demo_.note = action.note;
}

// In Off and Passive the robot acts by itself: Play starts and ends the demo that Advance selects.
void Device::tick_buttons(const Inputs& before) {
  if (mode_ == oi::Mode::safe || mode_ == oi::Mode::full) return;
  if (waiting()) return;  // it does not "react to any inputs, serial or otherwise" (OI p. 15)
  constexpr auto kDemos = static_cast<std::int32_t>(oi::DemoNumber::banjo) + 1;
  if (seen_.advance_button && !before.advance_button)
    demo_.selected = (demo_.selected + 1) % kDemos;
  if (!seen_.play_button || before.play_button) return;
  const bool ends = demo_.demos.running();
  demo_.demos.start(ends ? static_cast<std::int32_t>(oi::DemoNumber::abort) : demo_.selected,
                    demo_view());
  if (ends) stop_motors();
}

// A script longer than the manual's 100 bytes is not stored; the old one stays, as with songs.
void Device::store_script(std::span<const std::uint8_t> body) {
  if (body.size() > oi::kMaxScriptBytes) return;
  script_.bytes.clear();
  (void)script_.bytes.append(body);  // it fits: checked above
}

// "Loads a script into the serial input queue" (OI p. 15): after what is already there. A script
// that replays itself without a wait does so once a tick.
void Device::play_script() {
  if (script_.bytes.empty()) return;
  if (script_.tick == ticks_ && script_.played) {
    wait_.for_tick(now_);
    script_.again = true;
    return;
  }
  script_.played = true;
  script_.tick = ticks_;
  for (const std::uint8_t byte : script_.bytes) {
    if (!serial_.input.push_back(byte)) ++counters_.bytes_overrun;
  }
}

void Device::tick_wait() {
  wait_.look({.now = now_,
              .distance_mm = chassis_.odometer.distance_mm(),
              .angle_deg = chassis_.odometer.angle_deg(),
              .seen = &seen_,
              .mode = mode_});
  if (waiting() || !script_.again) return;
  script_.again = false;
  play_script();
}

void Device::show_script() {
  stream_.pause();
  oi::FixedList<std::uint8_t, 1 + oi::kMaxScriptBytes> answer;
  (void)answer.push_back(static_cast<std::uint8_t>(script_.bytes.size()));
  (void)answer.append(script_.bytes);
  reply_.begin_bytes(answer);
  reply();
}

}  // namespace cargobay::hal::sim
