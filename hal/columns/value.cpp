#include "hal/columns/value.hpp"

#include <cmath>

#include "hal/json_object.hpp"

namespace cargobay::hal {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

void append_number(std::string& out, std::int64_t number) { out += digits(number); }

void append_number(std::string& out, double number) {
  const std::string text = digits(number);
  out += text;
  if (text.find_first_of(".e") == std::string::npos) out += ".0";
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

void append_json(std::string& out, const Value& value) {
  if (!known(value)) {
    out += "null";
    return;
  }
  std::visit(Overloaded{[](std::monostate) {}, [&](bool truth) { out += truth ? "true" : "false"; },
                        [&](const std::string& text) { out += json_text(text); },
                        [&](const std::vector<std::string_view>& words) {
                          out += '[';
                          for (std::size_t i = 0; i < words.size(); ++i) {
                            if (i > 0) out += ',';
                            out += json_text(words[i]);
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

void MemberWriter::put(std::string_view path, const Value& value) {
  if (!known(value)) return;
  const std::size_t dot = path.find('.');
  const std::string_view group =
      dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
  if (group != group_) {
    end();
    group_ = group;
    if (!group.empty()) {
      key(group);
      out_ += '{';
    }
  }
  key(group.empty() ? path : path.substr(dot + 1));
  append_json(out_, value);
}

void MemberWriter::end() {
  if (!group_.empty()) out_ += '}';
  group_ = {};
}

void MemberWriter::key(std::string_view name) {
  if (!out_.ends_with('{')) out_ += ',';
  ((out_ += '"') += name) += "\":";
}

}  // namespace cargobay::hal
