#include "hal/json_object.hpp"

#include <cstdio>

namespace cargobay::hal {

namespace {

struct Range {
  unsigned char first = 0x80;
  unsigned char last = 0xbf;
};

// How long the UTF-8 sequence is that begins with this byte, 0 if none does; and what its second
// byte may be (Unicode 15, table 3-7).
std::size_t sequence_length(unsigned char first, Range& second) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return 2;
  if (first >= 0xe0 && first <= 0xef) {
    if (first == 0xe0) second.first = 0xa0;
    if (first == 0xed) second.last = 0x9f;
    return 3;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    if (first == 0xf0) second.first = 0x90;
    if (first == 0xf4) second.last = 0x8f;
    return 4;
  }
  return 0;
}

// Of the character at the beginning of the text; 0 if it is none.
std::size_t character_length(std::string_view text) {
  Range second;
  const std::size_t length = sequence_length(static_cast<unsigned char>(text.front()), second);
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const Range range = i == 1 ? second : Range{};
    if (byte < range.first || byte > range.last) return 0;
  }
  return length;
}

}  // namespace

std::string json_text(std::string_view text) {
  std::string out{"\""};
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const char first = text.front();
    if (length == 0) {
      out += "\xEF\xBF\xBD";
    } else if (first == '"' || first == '\\') {
      (out += '\\') += first;
    } else if (static_cast<unsigned char>(first) < 0x20U) {
      std::array<char, 8> escaped{};
      (void)std::snprintf(escaped.data(), escaped.size(), "\\u%04x", static_cast<unsigned>(first));
      out += escaped.data();
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out += '"';
}

}  // namespace cargobay::hal
