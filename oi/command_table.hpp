// The commands of the Open Interface (OI p. 7 to 16, 22), the one source for encoder, parser,
// names, ranges, text form and documentation.
//
// Where the manual contradicts itself, this table says: a script's length is in bytes, Wait Event
// goes to 22, Wait Distance and Wait Angle are any signed 16 bits, and Start is what leaves Off.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "oi/limits.hpp"
#include "oi/units.hpp"

namespace cargobay::oi {

// OI mode, the value of packet 35 (OI p. 6).
enum class Mode : std::uint8_t { off = 0, passive = 1, safe = 2, full = 3 };

// One number in a command, as it travels.
struct ArgumentInfo {
  std::string_view name;
  std::uint8_t size = 1;  // bytes, high byte first
  bool is_signed = false;
  std::int32_t min = 0;
  std::int32_t max = 0;
  Unit unit = Unit::none;
  std::array<std::int32_t, 2> specials{};  // valid values outside the range; 0 for none
  std::uint8_t mask = 0xff;                // for a one-byte bit set: the bits that exist
  bool zero_allowed = true;

  constexpr bool accepts(std::int32_t value) const {
    for (const std::int32_t special : specials) {
      if (special != 0 && value == special) return true;
    }
    if (value < min || value > max || (value == 0 && !zero_allowed)) return false;
    return size != 1 || is_signed || (value & ~std::int32_t{mask}) == 0;
  }
};

// What follows the arguments, as many times as the last argument says.
enum class Tail : std::uint8_t { none, packet_ids, notes, script_bytes };

// Bytes of one element of the tail.
constexpr std::size_t element_size(Tail tail) {
  return tail == Tail::none ? 0 : tail == Tail::notes ? 2 : 1;
}

// The numbers in one element of the tail (defined below, next to the table).
constexpr std::span<const ArgumentInfo> element_arguments(Tail tail);

// What a command does to the mode (OI p. 7 to 16).
enum class ModeChange : std::uint8_t { none, to_passive, to_safe, to_full };

struct CommandInfo {
  std::uint8_t opcode = 0;
  std::string_view key;   // in the text form: the manual's name in snake case
  std::string_view name;  // in the manual
  std::array<ArgumentInfo, 4> argument_slots{};
  std::uint8_t argument_count = 0;
  Tail tail = Tail::none;
  bool actuates = false;  // accepted in Safe and Full only
  ModeChange change = ModeChange::none;
  std::uint8_t page = 0;  // of the manual

  constexpr std::span<const ArgumentInfo> arguments() const {
    return {argument_slots.data(), argument_count};
  }
  // Bytes that follow the opcode before a tail.
  constexpr std::size_t argument_bytes() const {
    std::size_t sum = 0;
    for (const ArgumentInfo& argument : arguments()) sum += argument.size;
    return sum;
  }
  constexpr bool available_in(Mode mode) const {
    if (mode == Mode::off) return opcode == 128;
    return mode != Mode::passive || !actuates;
  }
};

namespace detail {

constexpr ArgumentInfo u8(std::string_view name, std::int32_t min, std::int32_t max,
                          Unit unit = Unit::none) {
  return {.name = name, .min = min, .max = max, .unit = unit};
}
constexpr ArgumentInfo bits(std::string_view name, std::uint8_t mask) {
  return {.name = name, .min = 0, .max = mask, .mask = mask};
}
constexpr ArgumentInfo s16(std::string_view name, std::int32_t min, std::int32_t max, Unit unit) {
  return {.name = name, .size = 2, .is_signed = true, .min = min, .max = max, .unit = unit};
}

template <typename... Arguments>
constexpr CommandInfo command(std::uint8_t opcode, std::string_view key, std::string_view name,
                              std::uint8_t page, Arguments... arguments) {
  CommandInfo info{.opcode = opcode, .key = key, .name = name, .page = page};
  ((info.argument_slots[info.argument_count++] = arguments), ...);
  return info;
}
constexpr CommandInfo actuator(CommandInfo info) {
  info.actuates = true;
  return info;
}
constexpr CommandInfo with_tail(Tail tail, CommandInfo info) {
  info.tail = tail;
  return info;
}
constexpr CommandInfo changes(ModeChange change, CommandInfo info) {
  info.change = change;
  return info;
}

}  // namespace detail

inline constexpr std::size_t kCommandCount = 29;

// In the order of their opcodes. Arguments are in wire order (right before left).
// clang-format off
inline constexpr std::array<CommandInfo, kCommandCount> kCommands = [] {
  using namespace detail;  // NOLINT(google-build-using-namespace): names of this table only
  constexpr std::int32_t kSpeed = kMaxWheelSpeed;
  ArgumentInfo demo_number = u8("demo", -1, 9);
  demo_number.is_signed = true;
  ArgumentInfo radius = s16("radius", -kMaxRadius, kMaxRadius, Unit::mm);
  radius.specials = {-32768, 32767};  // straight, both ways of writing it
  ArgumentInfo event = u8("event", -22, 22);
  event.is_signed = true;
  event.zero_allowed = false;
  return std::array<CommandInfo, kCommandCount>{{
    changes(ModeChange::to_passive, command(128, "start", "Start", 7)),
    command(129, "baud", "Baud", 7, u8("code", 0, 11)),
    changes(ModeChange::to_safe, command(130, "control", "Control", 7)),
    changes(ModeChange::to_safe, command(131, "safe", "Safe", 7)),
    changes(ModeChange::to_full, command(132, "full", "Full", 7)),
    changes(ModeChange::to_passive, command(134, "spot", "Spot", 8)),
    changes(ModeChange::to_passive, command(135, "cover", "Cover", 8)),
    changes(ModeChange::to_passive, command(136, "demo", "Demo", 8, demo_number)),
    actuator(command(137, "drive", "Drive", 9, s16("velocity", -kSpeed, kSpeed, Unit::mm_per_sec), radius)),
    actuator(command(138, "low_side_drivers", "Low Side Drivers", 10, bits("drivers", 0b111))),
    actuator(command(139, "leds", "LEDs", 9, bits("leds", 0b1010), u8("power_color", 0, 255), u8("power_intensity", 0, 255))),
    with_tail(Tail::notes, command(140, "song", "Song", 11, u8("slot", 0, 15), u8("length", 1, kMaxSongNotes))),
    actuator(command(141, "play", "Play Song", 13, u8("slot", 0, 15))),
    command(142, "sensors", "Sensors", 13, u8("packet", 0, 42)),
    changes(ModeChange::to_passive, command(143, "cover_and_dock", "Cover and Dock", 8)),
    actuator(command(144, "pwm_low_side_drivers", "PWM Low Side Drivers", 10, u8("driver_2", 0, 128), u8("driver_1", 0, 128), u8("driver_0", 0, 128))),
    actuator(command(145, "drive_direct", "Drive Direct", 9, s16("right", -kSpeed, kSpeed, Unit::mm_per_sec), s16("left", -kSpeed, kSpeed, Unit::mm_per_sec))),
    actuator(command(147, "digital_outputs", "Digital Outputs", 10, bits("outputs", 0b111))),
    with_tail(Tail::packet_ids, command(148, "stream", "Stream", 14, u8("count", 0, kMaxStreamPackets))),
    with_tail(Tail::packet_ids, command(149, "query_list", "Query List", 13, u8("count", 0, kMaxQueryPackets))),
    command(150, "pause_resume_stream", "Pause/Resume Stream", 14, u8("state", 0, 1)),
    actuator(command(151, "send_ir", "Send IR", 11, u8("byte", 0, 255))),
    with_tail(Tail::script_bytes, command(152, "script", "Script", 15, u8("length", 0, kMaxScriptBytes))),
    command(153, "play_script", "Play Script", 15),
    command(154, "show_script", "Show Script", 15),
    command(155, "wait_time", "Wait Time", 15, u8("time", 0, 255, Unit::tenth_of_second)),
    command(156, "wait_distance", "Wait Distance", 16, s16("distance", -32768, 32767, Unit::mm)),
    command(157, "wait_angle", "Wait Angle", 16, s16("angle", -32768, 32767, Unit::deg)),
    command(158, "wait_event", "Wait Event", 16, event),
  }};
}();
// clang-format on

namespace detail {

inline constexpr std::array<ArgumentInfo, 1> kPacketIdElement{u8("packet", 0, 42)};
inline constexpr std::array<ArgumentInfo, 2> kNoteElement{
    u8("note", 0, 255), u8("duration", 0, 255, Unit::sixty_fourth_of_second)};
inline constexpr std::array<ArgumentInfo, 1> kScriptByteElement{u8("byte", 0, 255)};

}  // namespace detail

constexpr std::span<const ArgumentInfo> element_arguments(Tail tail) {
  switch (tail) {
    case Tail::none: return {};
    case Tail::packet_ids: return detail::kPacketIdElement;
    case Tail::notes: return detail::kNoteElement;
    case Tail::script_bytes: return detail::kScriptByteElement;
  }
  return {};
}

// The number at the front of `bytes`, which must hold as many as the argument's size.
constexpr std::int32_t number_at(std::span<const std::uint8_t> bytes,
                                 const ArgumentInfo& argument) {
  std::int32_t value = bytes[0];
  if (argument.size == 2) value = value * 256 + bytes[1];
  const std::int32_t half = argument.size == 2 ? 0x8000 : 0x80;
  return argument.is_signed && value >= half ? value - 2 * half : value;
}

// The index of each opcode in a table of commands; its size for one that is not a command.
using CommandIndex = std::array<std::uint8_t, 256>;
constexpr CommandIndex index_of(std::span<const CommandInfo> commands) {
  CommandIndex index{};
  index.fill(static_cast<std::uint8_t>(commands.size()));
  for (std::size_t i = 0; i < commands.size(); ++i)
    index[commands[i].opcode] = static_cast<std::uint8_t>(i);
  return index;
}

// The entry of a command that is known to exist.
template <std::uint8_t kOpcode>
// NOLINTNEXTLINE(readability-identifier-naming): a constant, though by reference
inline constexpr const CommandInfo& kCommandInfo = kCommands[index_of(kCommands)[kOpcode]];

// Whole length in bytes, opcode included, of the command that begins with these bytes; 0 while they
// do not tell. `bytes` begins with the opcode of `info`.
constexpr std::size_t command_length(const CommandInfo& info, std::span<const std::uint8_t> bytes) {
  const std::size_t fixed = 1 + info.argument_bytes();
  if (info.tail == Tail::none) return fixed;
  if (bytes.size() < fixed) return 0;
  return fixed + bytes[fixed - 1] * element_size(info.tail);
}

// The most bytes that a robot may still wait for after an opcode, if it believes every count: all
// of a Song that claims to have 255 notes.
inline constexpr std::size_t kLongestRest = [] {
  std::size_t longest = 0;
  for (const CommandInfo& info : kCommands) {
    const std::size_t rest = info.argument_bytes() + 255 * element_size(info.tail);
    longest = rest > longest ? rest : longest;
  }
  return longest;
}();

}  // namespace cargobay::oi
