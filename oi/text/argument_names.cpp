#include "oi/text/argument_names.hpp"

#include <array>

#include "oi/baud.hpp"
#include "oi/commands.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {
namespace {

constexpr std::array<ValueName, 3> kRadii{{{"straight", kStraight.value},
                                           {"clockwise", kTurnClockwise.value},
                                           {"counter_clockwise", kTurnCounterClockwise.value}}};
constexpr std::array<ValueName, 11> kDemos{{{"abort", -1},
                                            {"cover", 0},
                                            {"cover_and_dock", 1},
                                            {"spot_cover", 2},
                                            {"mouse", 3},
                                            {"drive_figure_eight", 4},
                                            {"wimp", 5},
                                            {"home", 6},
                                            {"tag", 7},
                                            {"pachelbel", 8},
                                            {"banjo", 9}}};
constexpr std::array<ValueName, 44> kEvents{{
    {"wheel_drop", 1},
    {"no_wheel_drop", -1},
    {"front_wheel_drop", 2},
    {"no_front_wheel_drop", -2},
    {"left_wheel_drop", 3},
    {"no_left_wheel_drop", -3},
    {"right_wheel_drop", 4},
    {"no_right_wheel_drop", -4},
    {"bump", 5},
    {"no_bump", -5},
    {"left_bump", 6},
    {"no_left_bump", -6},
    {"right_bump", 7},
    {"no_right_bump", -7},
    {"virtual_wall", 8},
    {"no_virtual_wall", -8},
    {"wall", 9},
    {"no_wall", -9},
    {"cliff", 10},
    {"no_cliff", -10},
    {"left_cliff", 11},
    {"no_left_cliff", -11},
    {"front_left_cliff", 12},
    {"no_front_left_cliff", -12},
    {"front_right_cliff", 13},
    {"no_front_right_cliff", -13},
    {"right_cliff", 14},
    {"no_right_cliff", -14},
    {"home_base", 15},
    {"no_home_base", -15},
    {"advance_button", 16},
    {"no_advance_button", -16},
    {"play_button", 17},
    {"no_play_button", -17},
    {"digital_input_0", 18},
    {"no_digital_input_0", -18},
    {"digital_input_1", 19},
    {"no_digital_input_1", -19},
    {"digital_input_2", 20},
    {"no_digital_input_2", -20},
    {"digital_input_3", 21},
    {"no_digital_input_3", -21},
    {"mode_passive", 22},
    {"no_mode_passive", -22},
}};
constexpr std::array<ValueName, 2> kStreamStates{{{"pause", 0}, {"resume", 1}}};
constexpr std::array<ValueName, 1> kNotes{{{"rest", 0}}};
constexpr std::array<ValueName, 2> kLeds{{{"play", 0b0010}, {"advance", 0b1000}}};
constexpr std::array<ValueName, 3> kDrivers{
    {{"driver_0", 0b001}, {"driver_1", 0b010}, {"driver_2", 0b100}}};
constexpr std::array<ValueName, 3> kOutputs{
    {{"output_0", 0b001}, {"output_1", 0b010}, {"output_2", 0b100}}};
constexpr std::array<ValueName, kBaudRates.size()> kRates{{{"300", 0},
                                                           {"600", 1},
                                                           {"1200", 2},
                                                           {"2400", 3},
                                                           {"4800", 4},
                                                           {"9600", 5},
                                                           {"14400", 6},
                                                           {"19200", 7},
                                                           {"28800", 8},
                                                           {"38400", 9},
                                                           {"57600", 10},
                                                           {"115200", 11}}};
constexpr std::array<ValueName, kPacketCount> kPacketNames = [] {
  std::array<ValueName, kPacketCount> names{};
  for (std::size_t id = 0; id < kPacketCount; ++id)
    names[id] = {kPackets[id].key, static_cast<std::int32_t>(id)};
  return names;
}();

struct NamedArgument {
  std::string_view argument;
  std::span<const ValueName> names;
};
constexpr std::array<NamedArgument, 10> kNamedArguments{{{"code", kRates},
                                                         {"demo", kDemos},
                                                         {"radius", kRadii},
                                                         {"drivers", kDrivers},
                                                         {"leds", kLeds},
                                                         {"note", kNotes},
                                                         {"packet", kPacketNames},
                                                         {"outputs", kOutputs},
                                                         {"state", kStreamStates},
                                                         {"event", kEvents}}};

// Every name belongs to an argument in the command table, and means a value that it accepts.
constexpr bool accepts_all(const NamedArgument& named, std::span<const ArgumentInfo> arguments,
                           bool& found) {
  for (const ArgumentInfo& argument : arguments) {
    if (argument.name != named.argument) continue;
    found = true;
    for (const ValueName& name : named.names) {
      if (!argument.accepts(name.value)) return false;
    }
  }
  return true;
}
static_assert([] {
  for (const NamedArgument& named : kNamedArguments) {
    bool found = false;
    for (const CommandInfo& info : kCommands) {
      if (!accepts_all(named, info.arguments(), found)) return false;
      if (!accepts_all(named, element_arguments(info.tail), found)) return false;
    }
    if (!found) return false;
  }
  return true;
}());

constexpr std::size_t kFewNames = 12;  // are listed; of more, one is given as an example

void write_names(TextWriter& out, std::span<const ValueName> names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out.put(i + 1 == names.size() ? " or " : ", ");
    out.put(names[i].name);
  }
}

}  // namespace

std::span<const ValueName> value_names(const ArgumentInfo& argument) {
  for (const NamedArgument& named : kNamedArguments) {
    if (named.argument == argument.name) return named.names;
  }
  return {};
}

std::string_view value_name(const ArgumentInfo& argument, std::int32_t value) {
  for (const ValueName& name : value_names(argument)) {
    if (name.value == value) return name.name;
  }
  return {};
}

std::optional<std::int32_t> named_value(const ArgumentInfo& argument, std::string_view name) {
  for (const ValueName& candidate : value_names(argument)) {
    if (candidate.name == name) return candidate.value;
  }
  return std::nullopt;
}

void write_value(TextWriter& out, const ArgumentInfo& argument, std::int32_t value) {
  if (is_bit_set(argument) && argument.accepts(value)) {
    bool any = false;
    for (const ValueName& bit : value_names(argument)) {
      if ((value & bit.value) == 0) continue;
      if (any) out.put(",");
      out.put(bit.name);
      any = true;
    }
    if (!any) out.put(kNone);
    return;
  }
  const std::string_view name = value_name(argument, value);
  if (name.empty()) return out.put_number(value);
  out.put(name);
}

void write_choice(TextWriter& out, const ArgumentInfo& argument) {
  const std::span<const ValueName> names = value_names(argument);
  if (is_bit_set(argument)) {
    out.put("none, or ");
    for (const ValueName& bit : names) {
      if (&bit != names.data()) out.put(", ");
      out.put(bit.name);
      out.put(" (");
      out.put_number(bit.value);
      out.put(")");
    }
    return out.put(" separated by commas, or their sum");
  }
  out.put_number(argument.min);
  out.put(" to ");
  out.put_number(argument.max);
  if (argument.unit != Unit::none) {
    out.put(" ");
    out.put(symbol(argument.unit));
  }
  if (!argument.zero_allowed) out.put(" but not 0");
  if (names.empty()) return;
  out.put(", or ");
  if (names.size() <= kFewNames) return write_names(out, names);
  out.put("a name such as ");
  out.put(names[names.size() / 2].name);
}

}  // namespace cargobay::oi
