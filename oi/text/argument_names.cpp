#include "oi/text/argument_names.hpp"

#include <array>

#include "oi/baud.hpp"
#include "oi/commands.hpp"
#include "oi/packet_table.hpp"
#include "oi/text/song.hpp"

namespace cargobay::oi {
namespace {

constexpr auto kRadii =
    std::to_array<ValueName>({{kStraight.value, "straight"},
                              {kTurnClockwise.value, "clockwise"},
                              {kTurnCounterClockwise.value, "counter_clockwise"}});
constexpr auto kNotes = std::to_array<ValueName>({{kRest, kRestName}});

// Names made of others, each with a zero after it.
template <std::size_t kCount>
using Texts = std::array<std::array<char, 32>, kCount>;

constexpr auto kInverseTexts = [] {
  Texts<kValueNames<ScriptEvent>.size()> texts{};
  for (std::size_t i = 0; i < texts.size(); ++i) {
    TextWriter text{texts[i]};
    text.put("no_");
    text.put(kValueNames<ScriptEvent>[i].name);
  }
  return texts;
}();
constexpr auto kEvents = [] {
  std::array<ValueName, 2 * kInverseTexts.size()> names{};
  for (std::size_t i = 0; i < kInverseTexts.size(); ++i) {
    const ValueName& event = kValueNames<ScriptEvent>[i];
    names[2 * i] = event;
    names[2 * i + 1] = {-event.value, kInverseTexts[i].data()};
  }
  return names;
}();
constexpr auto kRateTexts = [] {
  Texts<kBaudRates.size()> texts{};
  for (std::size_t code = 0; code < texts.size(); ++code)
    TextWriter{texts[code]}.put_number(kBaudRates[code]);
  return texts;
}();
constexpr auto kRates = [] {
  std::array<ValueName, kBaudRates.size()> names{};
  for (std::size_t code = 0; code < names.size(); ++code)
    names[code] = {code, kRateTexts[code].data()};
  return names;
}();

// Flags by what they add to the number.
template <typename Flag>
constexpr auto kBits = [] {
  auto bits = kValueNames<Flag>;
  for (ValueName& bit : bits) bit.value = 1 << bit.value;
  return bits;
}();

constexpr std::array<ValueName, kPacketCount> kPacketNames = [] {
  std::array<ValueName, kPacketCount> names{};
  for (std::size_t id = 0; id < kPacketCount; ++id) names[id] = {id, kPackets[id].key};
  return names;
}();

struct NamedArgument {
  std::string_view argument;
  std::span<const ValueName> names;
};
constexpr std::array<NamedArgument, 10> kNamedArguments{{{"code", kRates},
                                                         {"demo", kValueNames<DemoNumber>},
                                                         {"radius", kRadii},
                                                         {"drivers", kBits<LowSideDriver>},
                                                         {"leds", kBits<Led>},
                                                         {"note", kNotes},
                                                         {"packet", kPacketNames},
                                                         {"outputs", kBits<DigitalOutput>},
                                                         {"state", kValueNames<StreamState>},
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
  return name_in(value_names(argument), value);
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
