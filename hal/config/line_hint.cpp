#include "hal/config/line_hint.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "hal/config/setting_table.hpp"
#include "oi/text/nearest_name.hpp"

namespace cargobay::hal {
namespace {

constexpr const char* kComment = "; a comment begins with #";

std::string_view stripped(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string_view numbered_line(std::string_view text, std::size_t line) {
  for (; line > 1; --line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return stripped(text.substr(0, text.find('\n')));
}

// “port” and ‘port’, as word processors write them.
std::string with_plain_quotes(std::string_view text) {
  constexpr std::array<std::string_view, 4> kCurved{"\u201c", "\u201d", "\u2018", "\u2019"};
  std::string plain{text};
  for (const std::string_view quote : kCurved) {
    for (std::size_t at = plain.find(quote); at != std::string::npos; at = plain.find(quote, at))
      plain.replace(at, quote.size(), "\"");
  }
  return plain;
}

bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

bool is_listed_word(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::any_of(
      words, [word](std::string_view each) { return oi::is_spelt_alike(each, word); });
}

// "true" or "false" for another way of saying it.
std::optional<std::string> as_flag(std::string_view value) {
  constexpr std::array<std::string_view, 4> kYes{"true", "yes", "on", "enabled"};
  constexpr std::array<std::string_view, 4> kNo{"false", "no", "off", "disabled"};
  if (is_listed_word(value, kYes)) return "true";
  if (is_listed_word(value, kNo)) return "false";
  return std::nullopt;
}

// A number with leading zeros, a unit or a comma: as it is to be written. The comma of a whole
// number groups its digits.
std::optional<std::string> as_number(std::string_view value, bool whole) {
  constexpr std::string_view kDigits = "0123456789.+-";
  while (value.size() > 1 && value[0] == '0' && is_decimal_digit(value[1])) value.remove_prefix(1);
  const std::size_t end = std::min(value.find_first_not_of(kDigits), value.size());
  if (end == 0 || value.find_first_of("0123456789") >= end) return std::nullopt;
  const std::string_view rest = value.substr(end);
  if (rest.starts_with(',') && std::ranges::all_of(rest.substr(1), is_decimal_digit))
    return std::string{value.substr(0, end)} + (whole ? "" : ".") + std::string{rest.substr(1)};
  return std::string{value.substr(0, end)};
}

const Setting* find_setting(std::string_view key) {
  for (const Setting& setting : settings()) {
    if (setting.key == key) return &setting;
  }
  return nullptr;
}

bool takes_text(std::string_view key) {
  const Setting* const setting = find_setting(key);
  if (setting == nullptr) return key == "chip" || key == "line" || key == "bias";
  return std::holds_alternative<std::string Config::*>(setting->member) ||
         std::holds_alternative<std::optional<rt::Remainder> Config::*>(setting->member);
}

bool takes_whole_number(std::string_view key) {
  const Setting* const setting = find_setting(key);
  return setting != nullptr &&
         (std::holds_alternative<std::optional<std::uint32_t> Config::*>(setting->member) ||
          std::holds_alternative<std::optional<int> Config::*>(setting->member));
}

// For a value that begins with a quote.
std::string hint_of_quoted(std::string_view value) {
  const std::size_t end = value.find(value.front(), 1);
  if (end == std::string_view::npos) return "; does its text end with a quote?";
  const std::string_view rest = stripped(value.substr(end + 1));
  if (rest.starts_with("//") || rest.starts_with(';')) return kComment;
  return rest.empty() || rest.starts_with('#') ? "" : "; nothing but a comment may follow the text";
}

std::string hint_of_value(std::string_view key, std::string_view value) {
  const std::string begin = std::string{key} + " = ";
  if (value.empty()) return "; its value is missing";
  if (const std::string plain = with_plain_quotes(value); plain != value)
    return "; quotes are plain ones: " + begin + plain;
  if (value.starts_with('"') || value.starts_with('\'')) return hint_of_quoted(value);
  if (const auto flag = as_flag(value); flag && !takes_text(key))
    return *flag == value ? "" : "; that is written: " + begin + *flag;
  if (const auto number = as_number(value, takes_whole_number(key)); number && !takes_text(key))
    return *number == value ? "" : "; a number is digits and a point alone: " + begin + *number;
  return "; text goes in quotes: " + begin + "\"" + std::string{value} + "\"";
}

}  // namespace

std::string line_hint(std::string_view text, std::size_t line) {
  const std::string_view words = numbered_line(text, line);
  if (words.empty() || words.starts_with('#')) return "";
  if (words.starts_with("//") || words.starts_with(';')) return kComment;
  if (words.starts_with('[')) {
    if (words.find(']') != std::string_view::npos) return "";
    return "; the name of a table goes in brackets: " + std::string{words} + "]";
  }
  const std::size_t equals = words.find('=');
  const std::size_t colon = words.find(':');
  if (equals == std::string_view::npos && colon == std::string_view::npos)
    return "; a line is a [table], or: key = value";
  if (equals == std::string_view::npos || colon < equals) {
    return "; a key and its value have = between them: " +
           std::string{stripped(words.substr(0, colon))} + " = " +
           std::string{stripped(words.substr(colon + 1))};
  }
  std::string_view value = stripped(words.substr(equals + 1));
  value = stripped(value.substr(0, value.find(" #")));
  const std::string_view key = stripped(words.substr(0, equals));
  return key.empty() ? "; the name before the = is missing" : hint_of_value(key, value);
}

}  // namespace cargobay::hal
