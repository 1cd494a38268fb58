// Writes a JSON object, member by member, without a tree of values: messages that go out at every
// tick of a robot are made in one string.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace cargobay::hal {

// Text as JSON has it, with its quotes; a byte that is not UTF-8 becomes U+FFFD.
std::string json_text(std::string_view text);

// The shortest digits that give the same number again; `null` for one that is not finite.
template <typename Number>
  requires std::integral<Number> || std::floating_point<Number>
std::string digits(Number number) {
  if constexpr (std::floating_point<Number>) {
    if (!std::isfinite(number)) return "null";
  }
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

// Keys are names from tables, and are not escaped.
class JsonObject {
 public:
  // The shortest digits that give the same number again.
  template <typename Number>
    requires(std::integral<Number> || std::floating_point<Number>) && (!std::same_as<Number, bool>)
  JsonObject& number(std::string_view key, Number value) {
    return raw(key, digits(value));
  }
  // To a thousandth; with the shortest digits if it has too many for that.
  JsonObject& thousandths(std::string_view key, double value) {
    std::array<char, 32> text{};
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 3);
    if (error != std::errc{} || !std::isfinite(value)) return number(key, value);
    return raw(key, {text.data(), end});
  }
  JsonObject& truth(std::string_view key, bool value) { return raw(key, value ? "true" : "false"); }
  JsonObject& text(std::string_view key, std::string_view value) {
    return raw(key, json_text(value));
  }
  JsonObject& object(std::string_view key, JsonObject value) { return raw(key, value.take()); }
  // `value` is JSON.
  JsonObject& raw(std::string_view key, std::string_view value) {
    text_ += text_.empty() ? "{\"" : ",\"";
    text_ += key;
    text_ += "\":";
    text_ += value;
    return *this;
  }
  // Several members at once, as JSON, with a comma before the first. The object is not empty.
  JsonObject& members(std::string_view more) {
    text_ += more;
    return *this;
  }
  // The object so far; nothing more may be put into it.
  std::string take() { return text_.empty() ? "{}" : std::move(text_) + "}"; }

 private:
  std::string text_;
};

// Likewise an array; its members are JSON.
class JsonArray {
 public:
  JsonArray& raw(std::string_view value) {
    text_ += text_.empty() ? '[' : ',';
    text_ += value;
    return *this;
  }
  JsonArray& text(std::string_view value) { return raw(json_text(value)); }
  std::string take() { return text_.empty() ? "[]" : std::move(text_) + "]"; }

 private:
  std::string text_;
};

}  // namespace cargobay::hal
