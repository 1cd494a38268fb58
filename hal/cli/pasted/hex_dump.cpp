#include "hal/cli/pasted/hex_dump.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include <fmt/format.h>

#include "hal/cli/pasted/text_lines.hpp"

namespace cargobay::cli {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Texts = std::vector<std::string_view>;

constexpr const char* kRemedy = "; if that is not the form, make the dump with: od -t x1";
constexpr std::size_t kMostDumped = std::size_t{16} << 20U;  // with what `*` stands for

std::optional<std::size_t> dump_number(std::string_view digits, int base) {
  std::size_t value = 0;
  const auto [stop, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  if (error != std::errc{} || stop != digits.data() + digits.size()) return std::nullopt;
  return value;
}

bool all_hex(std::string_view word) { return std::ranges::all_of(word, is_hex_digit); }

// How a dump is laid out, by its first line.
enum class DumpLayout : std::uint8_t { colon, canonical, words };

struct DumpLine {
  std::size_t number = 0;     // from 1
  std::string_view offset{};  // empty for `*`
  std::string_view values{};
  std::string_view characters{};  // the column on the right, if there is one
};

// The run of hexadecimal digits that a line begins with.
std::string_view leading_digits(std::string_view line) {
  const auto* const end = std::ranges::find_if_not(line, is_hex_digit);
  return line.substr(0, static_cast<std::size_t>(end - line.begin()));
}

std::optional<DumpLayout> layout_of(std::string_view first, std::size_t lines) {
  const std::string_view offset = leading_digits(first);
  const std::string_view rest = first.substr(offset.size());
  if (offset.size() >= 4 && (rest.starts_with(": ") || rest == ":")) return DumpLayout::colon;
  const bool decimal = std::ranges::none_of(offset, [](char c) { return c > '9'; });
  if (offset.size() == 7 && decimal && (rest.empty() || rest[0] == ' ')) return DumpLayout::words;
  const std::optional<std::size_t> value = dump_number(offset, 16);
  const bool round = value && *value % 16 == 0;
  const Texts words = words_of(rest);
  if (!round || words.empty()) return std::nullopt;
  if ((offset.size() == 8 || offset.size() == 4) && rest.starts_with("  ") && words[0].size() == 2)
    return DumpLayout::canonical;
  // od -A x; with one line only, six digits and six digits are six bytes.
  const bool zero = offset.size() == 6 && *value == 0;
  if (zero && rest[0] == ' ' && (lines > 1 || words[0].size() != 6)) return DumpLayout::words;
  return std::nullopt;
}

// Takes the column of characters off.
void cut_characters(DumpLine& line, DumpLayout layout) {
  std::string_view mark = layout == DumpLayout::colon ? "  " : "   ";
  if (layout == DumpLayout::canonical && line.values.ends_with('|')) mark = "  |";
  if (layout == DumpLayout::words) mark = "  >";
  const std::size_t end = line.values.find(mark);
  if (end == std::string_view::npos) return;
  line.characters = trimmed(line.values.substr(end));
  line.values = line.values.substr(0, end);
}

// What a dump shows beside these bytes, without blanks at the ends.
std::string shown_beside(const Bytes& bytes) {
  std::string shown;
  for (const std::uint8_t byte : bytes)
    shown += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '.';
  return std::string{trimmed(shown)};
}

// The bytes of one value.
using ReadValue = bool (*)(std::string_view word, Bytes& bytes);

template <int kBase, std::size_t kSize, bool kLittleEndian>
bool read_value(std::string_view word, Bytes& bytes) {
  const std::optional<std::size_t> value = dump_number(word, kBase);
  if (!value || (kSize < 8 && *value >> (8 * (kSize % 8)) != 0)) return false;
  for (std::size_t i = 0; i < kSize; ++i) {
    const std::size_t shift = 8 * (kLittleEndian ? i : kSize - 1 - i);
    bytes.push_back(static_cast<std::uint8_t>(*value >> shift));
  }
  return true;
}

bool read_signed(std::string_view word, Bytes& bytes) {
  int value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || stop != word.data() + word.size() || value < -128 || value > 255)
    return false;
  bytes.push_back(static_cast<std::uint8_t>(value));
  return true;
}

bool read_pairs(std::string_view word, Bytes& bytes) {
  if (word.empty() || word.size() % 2 != 0) return false;
  for (; !word.empty(); word.remove_prefix(2)) {
    if (!read_value<16, 1, false>(word.substr(0, 2), bytes)) return false;
  }
  return true;
}

bool read_reversed_pairs(std::string_view word, Bytes& bytes) {
  const std::size_t begin = bytes.size();
  if (!read_pairs(word, bytes)) return false;
  std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.end());
  return true;
}

// One of the fields of od -c: a character, an escape, or three octal digits.
bool read_character(std::string_view field, Bytes& bytes) {
  const std::string_view word = trimmed(field);
  constexpr std::string_view kEscapes = "0abtnvfr";
  constexpr std::string_view kValues{"\0\a\b\t\n\v\f\r", 8};
  if (word.size() == 3) return read_value<8, 1, false>(word, bytes);
  if (word.size() == 2 && word[0] == '\\') {
    const std::size_t at = kEscapes.find(word[1]);
    if (at == std::string_view::npos && word[1] != '\\') return false;
    bytes.push_back(static_cast<std::uint8_t>(word[1] == '\\' ? '\\' : kValues[at]));
    return true;
  }
  if (word.size() > 1) return false;
  bytes.push_back(static_cast<std::uint8_t>(word.empty() ? ' ' : word[0]));
  return true;
}

struct DumpFormat {
  std::string_view name{};
  ReadValue read = nullptr;
  std::size_t value_bytes = 1;
  std::size_t field = 0;  // characters of a value, if it can have blanks
};

class DumpReader {
 public:
  DumpReader(DumpLayout layout, Base base, std::string_view text) : layout_{layout}, base_{base} {
    const Texts lines = lines_of(text);
    for (std::size_t i = 0; i < lines.size(); ++i) add(i + 1, lines[i]);
  }

  hal::Result<Dump> read() {
    for (const DumpLine& line : lines_) {
      const bool star = line.offset.empty() && line.values.empty();
      if (!star && line.offset.size() < lines_.front().offset.size())
        return hal::Failure{fmt::format(
            "line {} has no offset; make the dump in one form, such as: od -t x1", line.number)};
    }
    const auto format = layout_ == DumpLayout::words ? format_of_words() : format_of_pairs();
    if (!format) return format.failure();
    std::optional<hal::Failure> failure;
    // od counts in octal, hexdump in hexadecimal, both with seven digits; xxd -d in decimal.
    std::vector bases{16};
    if (layout_ == DumpLayout::words && lines_.front().offset.size() == 7) bases = {8, 16, 10};
    if (layout_ == DumpLayout::colon) bases = {16, 10};
    for (const int base : bases) {
      auto bytes = assemble(*format, base);
      if (bytes) return Dump{format->name, std::move(*bytes)};
      if (!failure) failure = bytes.failure();
    }
    return *failure;
  }

 private:
  void add(std::size_t number, std::string_view text) {
    DumpLine line{.number = number};
    const std::string_view whole = trimmed(text);
    if (whole.empty()) return;
    if (whole != "*") {
      line.offset = leading_digits(whole);
      line.values = whole.substr(line.offset.size());
      if (layout_ == DumpLayout::colon && line.values.starts_with(':'))
        line.values.remove_prefix(1);
      const std::size_t begin = line.values.find_first_not_of(' ');
      if (layout_ != DumpLayout::words)
        line.values.remove_prefix(std::min(begin, line.values.size()));
      cut_characters(line, layout_);
    }
    lines_.push_back(line);
  }

  Texts all_words() const {
    Texts all;
    for (const DumpLine& line : lines_) {
      const Texts words = words_of(line.values);
      all.insert(all.end(), words.begin(), words.end());
    }
    return all;
  }

  // xxd and hexdump -C: which of their forms agrees with the characters on the right.
  hal::Result<DumpFormat> format_of_pairs() const {
    constexpr std::array<DumpFormat, 3> kForms{{{"xxd or hexdump -C", read_pairs},
                                                {"xxd -e", read_reversed_pairs},
                                                {"xxd -b", read_value<2, 1, false>}}};
    for (const DumpFormat& form : kForms) {
      if (std::ranges::all_of(lines_, [&](const DumpLine& line) { return agrees(form, line); }))
        return form;
    }
    for (const DumpLine& line : lines_) {
      if (const auto read = values(kForms[0], line); !read) return read.failure();
      if (!agrees(kForms[0], line)) {
        return hal::Failure{
            fmt::format("line {}: the bytes and the characters beside them differ", line.number)};
      }
    }
    return hal::Failure{"the bytes and the characters beside them differ"};
  }

  static bool agrees(const DumpFormat& form, const DumpLine& line) {
    Bytes bytes;
    for (const std::string_view word : words_of(line.values)) {
      if (!form.read(word, bytes)) return false;
    }
    std::string_view characters = line.characters;
    if (characters.starts_with('|') && characters.ends_with('|') && characters.size() >= 2)
      characters = characters.substr(1, characters.size() - 2);
    if (characters.empty()) return true;
    return trimmed(characters) == shown_beside(bytes);
  }

  hal::Result<DumpFormat> format_of_words() const {
    const Texts words = all_words();
    const auto all = [&words](std::size_t size, auto&& is) {
      return std::ranges::all_of(
          words, [&](std::string_view word) { return word.size() == size && is(word); });
    };
    const auto reads = [](ReadValue value) {
      return [value](std::string_view word) {
        Bytes ignored;
        return value(word, ignored);
      };
    };
    if (all(2, all_hex)) return DumpFormat{"od or hexdump", read_value<16, 1, false>};
    if (all(4, all_hex)) return DumpFormat{"od or hexdump, words", read_value<16, 2, true>, 2};
    if (all(8, all_hex)) return DumpFormat{"od, words", read_value<16, 4, true>, 4};
    if (all(16, all_hex)) return DumpFormat{"od, words", read_value<16, 8, true>, 8};
    if (all(6, reads(read_value<8, 2, true>))) return DumpFormat{"od", read_value<8, 2, true>, 2};
    const bool octal = all(3, reads(read_value<8, 1, false>));
    const bool decimal = std::ranges::all_of(words, reads(read_signed));
    const bool leading_zero =
        std::ranges::any_of(words, [](std::string_view word) { return word.starts_with('0'); });
    if (octal && decimal && !leading_zero) {
      if (base_ == Base::decimal) return DumpFormat{"od in decimal", read_signed};
      return hal::Failure{
          "these bytes can be octal or decimal; if they are decimal, say --decimal; if not, make "
          "the dump with: od -t x1"};
    }
    if (all(5, reads(read_value<10, 2, true>)))
      return DumpFormat{"hexdump -d", read_value<10, 2, true>, 2};
    if (octal) return DumpFormat{"od -b", read_value<8, 1, false>};
    if (decimal) return DumpFormat{"od in decimal", read_signed};
    return DumpFormat{"od -c", read_character, 1, 4};
  }

  hal::Result<Bytes> values(const DumpFormat& format, const DumpLine& line) const {
    Bytes bytes;
    Texts words = words_of(line.values);
    if (format.field != 0) {
      words.clear();
      for (std::size_t at = 0; at < line.values.size(); at += format.field)
        words.push_back(line.values.substr(at, format.field));
    }
    for (const std::string_view word : words) {
      if (format.read(word, bytes)) continue;
      return hal::Failure{fmt::format("line {}: '{}' is not a value of {}{}", line.number, word,
                                      format.name, kRemedy)};
    }
    return bytes;
  }

  // od -c shows a blank as blanks: at the end of a line they get lost, or more of them are there.
  static void fit_blanks(Bytes& bytes, std::size_t wanted) {
    constexpr std::size_t kMostOfLine = 16;
    while (bytes.size() > wanted && bytes.back() == ' ') bytes.pop_back();
    if (bytes.size() < wanted && wanted - bytes.size() < kMostOfLine) bytes.resize(wanted, ' ');
  }

  // How many bytes are before this line, by its offset and that of the first line.
  hal::Result<std::size_t> bytes_before(const DumpLine& line, int base) const {
    const auto begin = dump_number(lines_.front().offset, base);
    const auto offset = dump_number(line.offset, base);
    if (!begin || !offset || *offset < *begin) {
      return hal::Failure{
          fmt::format("line {}: '{}' is not the next offset", line.number, line.offset)};
    }
    if (*offset - *begin > kMostDumped)
      return hal::Failure{fmt::format("line {}: the offset is too large", line.number)};
    return *offset - *begin;
  }

  // All lines one after the other, with offsets in this base.
  hal::Result<Bytes> assemble(const DumpFormat& format, int base) const {
    Bytes bytes;
    Bytes last;
    bool starred = false;
    for (const DumpLine& line : lines_) {
      if (line.offset.empty()) {
        if (last.empty())
          return hal::Failure{fmt::format("line {}: there is nothing to repeat", line.number)};
        starred = true;
        continue;
      }
      const auto wanted = bytes_before(line, base);
      if (!wanted) return wanted.failure();
      while (starred && bytes.size() < *wanted) bytes.insert(bytes.end(), last.begin(), last.end());
      starred = false;
      auto read = values(format, line);
      if (!read) return read.failure();
      if (format.field != 0) fit_blanks(bytes, *wanted);
      // The end of the dump is in the middle of a word.
      const bool at_end = read->empty() && bytes.size() - *wanted < format.value_bytes;
      if (at_end && bytes.size() > *wanted) bytes.resize(*wanted);
      if (bytes.size() != *wanted) {
        return hal::Failure{
            fmt::format("line {}: the offset {} does not fit the {} bytes before it", line.number,
                        line.offset, bytes.size())};
      }
      last = std::move(*read);
      bytes.insert(bytes.end(), last.begin(), last.end());
    }
    return bytes;
  }

  DumpLayout layout_;
  Base base_;
  std::vector<DumpLine> lines_{};
};

}  // namespace

std::optional<hal::Result<Dump>> read_dump(std::string_view text, Base base) {
  std::vector<std::string_view> lines = lines_of(text);
  std::erase_if(lines, [](std::string_view line) { return trimmed(line).empty(); });
  if (lines.empty()) return std::nullopt;
  const std::string_view first = trimmed(lines[0]);
  const std::optional<DumpLayout> layout = layout_of(first, lines.size());
  if (!layout) return std::nullopt;
  auto dump = DumpReader{*layout, base, text}.read();
  // Six zeros may be three bytes.
  if (!dump && *layout == DumpLayout::words && leading_digits(first).size() == 6)
    return std::nullopt;
  return dump;
}

}  // namespace cargobay::cli
