#include "hal/config/config_edit.hpp"

#include <algorithm>

namespace cargobay::hal {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// The key that a line sets; empty if it sets none.
std::string_view key_of(std::string_view line) {
  const std::size_t equals = line.find('=');
  const std::string_view key = trimmed(line.substr(0, equals));
  return equals == std::string_view::npos || key.starts_with('#') ? std::string_view{} : key;
}

// A # inside a string does not begin a comment.
std::string comment_of(std::string_view line) {
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] == '#' && !quoted) return "  " + std::string{line.substr(i)};
  }
  return "";
}

bool is_head(std::string_view line) { return trimmed(line).starts_with('['); }

}  // namespace

std::string set_values(std::string_view text, std::string_view table,
                       const std::vector<ConfigValue>& values) {
  std::vector<std::string> lines = lines_of(text);
  const std::string head = "[" + std::string{table} + "]";
  auto begin = std::ranges::find_if(
      lines, [&](const std::string& line) { return trimmed(line).starts_with(head); });
  if (begin == lines.end()) {
    if (!lines.empty()) lines.emplace_back();
    lines.push_back(head);
    begin = lines.end() - 1;
  }
  auto first = static_cast<std::size_t>(begin - lines.begin()) + 1;
  for (const ConfigValue& value : values) {
    auto end = static_cast<std::size_t>(
        std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), is_head) -
        lines.begin());
    const std::string set = value.key + " = " + value.value;
    const auto old =
        std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(first),
                     lines.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](const std::string& line) { return key_of(line) == value.key; });
    if (old != lines.begin() + static_cast<std::ptrdiff_t>(end)) {
      *old = set + comment_of(*old);
      continue;
    }
    while (end > first && trimmed(lines[end - 1]).empty()) --end;
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(end), set);
  }
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

}  // namespace cargobay::hal
