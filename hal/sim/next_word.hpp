// Takes lines of text apart: the next word, and what number it is.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace cargobay::hal::sim {

// Takes the next word off the front of `rest`; empty if there is none.
inline std::string_view next_word(std::string_view& rest) {
  constexpr std::string_view kBlank = " \t\r";
  rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
  const std::string_view word = rest.substr(0, std::min(rest.find_first_of(kBlank), rest.size()));
  rest.remove_prefix(word.size());
  return word;
}

inline bool no_more_words(std::string_view rest) { return next_word(rest).empty(); }

// The word as a number; nothing if it is not one, or is out of bounds.
inline std::optional<double> to_number(std::string_view word, double lowest, double highest) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  if (!(value >= lowest && value <= highest)) return std::nullopt;
  return value;
}

// The same for a whole number.
inline std::optional<int> to_integer(std::string_view word, int lowest, int highest) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  if (value < lowest || value > highest) return std::nullopt;
  return value;
}

}  // namespace cargobay::hal::sim
