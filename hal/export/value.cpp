#include "hal/export/value.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

void append_number(std::string& out, std::int64_t number) {
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.begin(), digits.end(), number);
  out.append(digits.data(), end.ptr);
}

void append_number(std::string& out, double number) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.begin(), digits.end(), number);
  const std::string_view text{digits.data(), end.ptr};
  out += text;
  if (text.find_first_of(".e") == std::string_view::npos) out += ".0";
}

bool plain(std::string_view text) {
  for (const char c : text) {
    if (c < 0x20 || c == '"' || c == '\\' || c == 0x7F) return false;  // beyond ASCII is negative
  }
  return true;
}

void append_quoted_csv(std::string& out, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    out += text;
    return;
  }
  out += '"';
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  out += '"';
}

}  // namespace

bool known(const Value& value) {
  const auto* const number = std::get_if<double>(&value);
  return number != nullptr ? std::isfinite(*number)
                           : !std::holds_alternative<std::monostate>(value);
}

void append_json_text(std::string& out, std::string_view text) {
  if (plain(text)) {
    ((out += '"') += text) += '"';
    return;
  }
  using nlohmann::json;
  out += json(text).dump(-1, ' ', false, json::error_handler_t::replace);
}

void append_json(std::string& out, const Value& value) {
  if (!known(value)) {
    out += "null";
    return;
  }
  std::visit(Overloaded{[](std::monostate) {}, [&](bool truth) { out += truth ? "true" : "false"; },
                        [&](const std::string& text) { append_json_text(out, text); },
                        [&](const std::vector<std::string_view>& words) {
                          out += '[';
                          for (std::size_t i = 0; i < words.size(); ++i) {
                            if (i > 0) out += ',';
                            append_json_text(out, words[i]);
                          }
                          out += ']';
                        },
                        [&](auto number) { append_number(out, number); }},
             value);
}

void append_csv(std::string& out, const Value& value) {
  if (!known(value)) return;
  std::visit(Overloaded{[](std::monostate) {}, [&](bool truth) { out += truth ? '1' : '0'; },
                        [&](const std::string& text) { append_quoted_csv(out, text); },
                        [&](const std::vector<std::string_view>& words) {
                          if (words.empty()) out += "none";
                          for (std::size_t i = 0; i < words.size(); ++i) {
                            if (i > 0) out += ';';
                            out += words[i];
                          }
                        },
                        [&](auto number) { append_number(out, number); }},
             value);
}

void ObjectWriter::put(std::string_view path, const Value& value) {
  if (!known(value)) return;
  const std::size_t dot = path.find('.');
  const std::string_view group =
      dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
  if (group != group_) {
    if (!group_.empty()) out_ += '}';
    after_member_ = after_member_ || !group_.empty();
    group_ = group;
    if (!group.empty()) {
      if (std::exchange(after_member_, false)) out_ += ',';
      ((out_ += '"') += group) += "\":{";
    }
  }
  if (std::exchange(after_member_, true)) out_ += ',';
  ((out_ += '"') += group.empty() ? path : path.substr(dot + 1)) += "\":";
  append_json(out_, value);
}

void ObjectWriter::close() {
  if (!group_.empty()) out_ += '}';
  out_ += '}';
  group_ = {};
}

}  // namespace cargobay::hal
