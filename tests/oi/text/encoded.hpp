// Commands to text and back, for tests.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "oi/text/command_text.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {

struct Encoded {
  Bytes bytes;
  std::string error;  // as format_error() words it; empty if there is none
  std::optional<TextError> what;
};

inline Encoded encode_with_room(std::string_view text, std::size_t room,
                                Beyond beyond = Beyond::nothing) {
  // Allocated to exactly its size, so that a sanitizer sees a read past an end.
  const auto characters = std::make_unique<char[]>(text.size());
  std::copy(text.begin(), text.end(), characters.get());
  const auto out = std::make_unique<std::uint8_t[]>(room);
  const std::string_view exact{characters.get(), text.size()};
  const TextResult result = encode_text(exact, {out.get(), room}, beyond);
  Encoded encoded{
      .bytes = {out.get(), out.get() + result.bytes}, .error = {}, .what = result.error};
  if (!result.error) return encoded;
  EXPECT_EQ(result.bytes, 0U);
  EXPECT_LE(result.error->position + result.error->length, text.size());
  std::array<char, 400> message{};
  encoded.error.assign(message.data(), format_error(*result.error, exact, message));
  EXPECT_LT(encoded.error.size(), message.size()) << encoded.error;
  return encoded;
}

inline Encoded encoded(std::string_view text) { return encode_with_room(text, 1024); }
inline Bytes bytes_of(std::string_view text) {
  const Encoded result = encoded(text);
  EXPECT_EQ(result.error, "") << text;
  return result.bytes;
}
inline std::string error_of(std::string_view text) { return encoded(text).error; }

inline std::string text_of(const Bytes& command) {
  const auto out = std::make_unique<char[]>(kMaxCommandText);
  return {out.get(), format_command(command, {out.get(), kMaxCommandText})};
}

// Checks that the inverse holds for these bytes; returns their text.
inline std::string round_trip(const Bytes& command) {
  std::string text = text_of(command);
  EXPECT_NE(text, "");
  EXPECT_EQ(bytes_of(text), command) << text;
  return text;
}

}  // namespace cargobay::oi
