// The named values of commands' arguments: `straight`, `no_bump`, `play`, `distance`. For the text
// form of commands, for messages and for documentation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "oi/command_table.hpp"
#include "oi/text/text_writer.hpp"
#include "oi/value_names.hpp"

namespace cargobay::oi {

// A bit set is written as the names of its bits with commas between; kNoBits for none.
constexpr bool is_bit_set(const ArgumentInfo& argument) {
  return argument.size == 1 && argument.mask != 0xff;
}
inline constexpr std::string_view kNone = "none";

// All names for values of this argument of the command table; most arguments have none. Those of a
// baud code are the rates, in digits; those of a bit set, its bits, each with its value.
std::span<const ValueName> value_names(const ArgumentInfo& argument);

// The name of a value, empty if it has none; and back.
std::string_view value_name(const ArgumentInfo& argument, std::int32_t value);
std::optional<std::int32_t> named_value(const ArgumentInfo& argument, std::string_view name);

// A value by name if it has one, else in digits.
void write_value(TextWriter& out, const ArgumentInfo& argument, std::int32_t value);
// What the argument may be, in words: `-2000 to 2000 mm, or straight, clockwise or
// counter_clockwise`.
void write_choice(TextWriter& out, const ArgumentInfo& argument);

}  // namespace cargobay::oi
