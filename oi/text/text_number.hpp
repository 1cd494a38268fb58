// Integers in text, for the text forms of commands, scripts and songs.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace cargobay::oi {

namespace detail {

// The digit's value, whatever the base; 36 if it is not a digit.
constexpr std::int64_t digit_value(char character) {
  if (character >= '0' && character <= '9') return character - '0';
  if (character >= 'a' && character <= 'z') return character - 'a' + 10;
  if (character >= 'A' && character <= 'Z') return character - 'A' + 10;
  return 36;
}

}  // namespace detail

// Decimal, or hexadecimal after 0x, with a minus in front for negative numbers; nothing for
// anything else. A number too large for the type comes back as the type's largest or smallest.
constexpr std::optional<std::int32_t> parse_integer(std::string_view text) {
  using Limits = std::numeric_limits<std::int32_t>;
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  const std::int64_t base = hexadecimal ? 16 : 10;
  if (text.empty()) return std::nullopt;
  std::int64_t value = 0;
  for (const char character : text) {
    const std::int64_t digit = detail::digit_value(character);
    if (digit >= base) return std::nullopt;
    value = value * base + digit;
    if (value > Limits::max()) value = std::int64_t{Limits::max()} + 1;
  }
  if (negative) return static_cast<std::int32_t>(-value);
  return static_cast<std::int32_t>(value > Limits::max() ? Limits::max() : value);
}

}  // namespace cargobay::oi
