#include "hal/cli/pasted/pasted_bytes.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "hal/cli/pasted/analyser_export.hpp"
#include "hal/cli/pasted/hex_dump.hpp"
#include "hal/cli/pasted/line_samples.hpp"
#include "hal/cli/pasted/text_lines.hpp"

namespace cargobay::cli {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Numbers as Python and C write them: 137, 0x89.
hal::Result<Bytes> read_numbers(std::string_view text) {
  constexpr std::string_view kBetween = " \t\r\n,";
  Bytes bytes;
  for (std::size_t begin = text.find_first_not_of(kBetween); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBetween, begin), text.size());
    std::string_view digits = text.substr(begin, end - begin);
    const std::string word{digits};
    const bool hex = digits.starts_with("0x") || digits.starts_with("0X");
    if (hex) digits.remove_prefix(2);
    unsigned value = 0;
    const auto [stop, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 10);
    if (error != std::errc{} || stop != digits.data() + digits.size() || value > 255)
      return hal::Failure{fmt::format("'{}' is not a byte: 0 to 255, or 0x00 to 0xff", word)};
    bytes.push_back(static_cast<std::uint8_t>(value));
    begin = text.find_first_not_of(kBetween, end);
  }
  return bytes;
}

// The literals of Python in a text, one after the other: b'\x89\xff8', bytes([137, 255]),
// bytearray(...), bytes.fromhex('89 ff'), array('B', [137, 255]).
class PythonReader {
 public:
  explicit PythonReader(std::string_view text) : text_{text} {}

  // Nothing if there is no literal.
  std::optional<hal::Result<Bytes>> read() {
    bool found = false;
    while (at_ < text_.size()) {
      const bool begins = at_ == 0 || !is_alphanumeric(text_[at_ - 1]);
      if (begins && (starts("b'") || starts("b\""))) {
        found = true;
        if (auto wrong = literal()) return *wrong;
      } else if (begins && starts("fromhex(")) {
        found = true;
        if (auto wrong = inside(
                ')', [](std::string_view hex) { return read_bytes(hex, Base::hexadecimal); }))
          return *wrong;
      } else if (begins && (starts("bytes([") || starts("bytearray([") || starts("array('B', ["))) {
        found = true;
        at_ = text_.find('[', at_);
        if (auto wrong = inside(']', read_numbers)) return *wrong;
      } else {
        ++at_;
      }
    }
    if (!found) return std::nullopt;
    return bytes_;
  }

 private:
  bool starts(std::string_view word) const { return text_.substr(at_).starts_with(word); }

  template <typename Read>
  std::optional<hal::Failure> inside(char close, Read numbers) {
    const std::size_t begin = std::min(text_.find_first_of("([", at_), text_.size()) + 1;
    const std::size_t end = text_.find(close, begin);
    if (end == std::string_view::npos)
      return hal::Failure{fmt::format("the {} of Python's bytes is missing", close)};
    const auto more = numbers(text_.substr(begin, end - begin));
    if (!more) return more.failure();
    bytes_.insert(bytes_.end(), more->begin(), more->end());
    at_ = end + 1;
    return std::nullopt;
  }

  std::optional<hal::Failure> literal() {
    const char quote = text_[at_ + 1];
    for (at_ += 2; at_ < text_.size() && text_[at_] != quote;) {
      const char c = text_[at_];
      if (c == '\\') {
        if (!escape()) {
          return hal::Failure{fmt::format("column {}: not an escape of Python's bytes", at_ + 1)};
        }
        continue;
      }
      if (static_cast<unsigned char>(c) >= 0x80)
        return hal::Failure{fmt::format("column {}: Python's bytes are ASCII", at_ + 1)};
      bytes_.push_back(static_cast<std::uint8_t>(c));
      ++at_;
    }
    if (at_ == text_.size()) return hal::Failure{"the closing quote of Python's bytes is missing"};
    ++at_;
    return std::nullopt;
  }

  bool escape() {
    const std::string_view rest = text_.substr(at_ + 1);
    if (rest.starts_with('x')) return digits(rest.substr(1, 2), 2, 16, 2);
    const auto* const end = std::find_if(
        rest.begin(),
        rest.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(rest.size(), 3)),
        [](char c) { return c < '0' || c > '7'; });
    const auto octal = static_cast<std::size_t>(end - rest.begin());
    if (octal > 0) return digits(rest.substr(0, octal), octal, 8, 1);
    constexpr std::string_view kNames = "abtnvfr\\'\"";
    constexpr std::string_view kValues = "\a\b\t\n\v\f\r\\'\"";
    const std::size_t known = rest.empty() ? std::string_view::npos : kNames.find(rest[0]);
    if (known == std::string_view::npos) return false;
    bytes_.push_back(static_cast<std::uint8_t>(kValues[known]));
    at_ += 2;
    return true;
  }
  // `mark` characters are before the digits.
  bool digits(std::string_view text, std::size_t count, int base, std::size_t mark) {
    unsigned value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (text.size() != count || error != std::errc{} || stop != text.data() + count || value > 255)
      return false;
    bytes_.push_back(static_cast<std::uint8_t>(value));
    at_ += mark + count;
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  Bytes bytes_{};
};

// `unsigned char x[] = { 0x89, 255 };`, as xxd -i writes it.
std::optional<hal::Result<Bytes>> read_c_array(std::string_view text) {
  const std::size_t open = text.find('{');
  const std::size_t equals = text.find('=');
  if (open == std::string_view::npos || equals == std::string_view::npos || equals > open)
    return std::nullopt;
  const std::size_t close = text.find('}', open);
  if (close == std::string_view::npos) return hal::Failure{"the } of the array is missing"};
  return read_numbers(text.substr(open + 1, close - open - 1));
}

hal::Result<Pasted> one_line(std::string_view form, const hal::Result<Bytes>& bytes) {
  if (!bytes) return bytes.failure();
  return Pasted{form, {PastedLine{{}, *bytes}}};
}

}  // namespace

hal::Result<Pasted> read_pasted(std::string_view text, Base base, std::uint32_t baud) {
  if (const auto bytes = PythonReader{text}.read()) return one_line("Python's bytes", *bytes);
  if (const auto bytes = read_c_array(text)) return one_line("an array of C", *bytes);
  if (const auto samples = read_line_samples(text, baud)) return *samples;
  if (const auto table = read_analyser_export(text)) return *table;
  if (const auto dump = read_dump(text, base)) {
    if (!*dump) return dump->failure();
    return one_line((*dump)->form, (*dump)->bytes);
  }
  return one_line({}, read_bytes(text, base));
}

}  // namespace cargobay::cli
