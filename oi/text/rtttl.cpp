#include "oi/text/rtttl.hpp"

#include <algorithm>
#include <array>

#include "oi/text/lower.hpp"
#include "oi/text/text_slice.hpp"

namespace cargobay::oi {
namespace {

using What = RtttlError::What;

constexpr int kMaxBeatsPerMinute = 900;
constexpr int kMaxDivision = 64;  // a 1/64 note is the shortest

constexpr bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct Defaults {
  int division = 4;
  int octave = 6;
  int beats_per_minute = 63;
};

constexpr bool is_division(int number) { return number >= 1 && kMaxDivision % number == 0; }

// One note as written.
struct Written {
  int division = 4;  // 1/division of a whole note
  bool dotted = false;
  std::uint8_t number = kRest;
};

std::optional<std::uint8_t> find_note(char letter, bool sharp, int octave) {
  if (octave > 9) return std::nullopt;
  const std::array name{letter, '#', static_cast<char>('0' + octave)};
  const std::array natural{letter, name.back()};
  return sharp ? oi::find_note({name.data(), name.size()})
               : oi::find_note({natural.data(), natural.size()});
}

class RtttlReader {
 public:
  explicit RtttlReader(std::string_view text) : text_{text} {}

  bool read(RingTone& tone) { return name(tone.name) && defaults() && notes(tone.notes); }
  const RtttlError& error() const { return error_; }

 private:
  bool fail(What what, std::size_t position) {
    error_ = {what, position + 1};
    return false;
  }
  // The next character that is not white space, in lower case; 0 at the end.
  char peek() {
    while (position_ < text_.size() && is_space(text_[position_])) ++position_;
    return position_ < text_.size() ? lower(text_[position_]) : '\0';
  }
  std::size_t next_position() {
    (void)peek();  // called to skip white space
    return position_;
  }
  bool at_end() { return peek() == '\0' && position_ == text_.size(); }
  bool take(char wanted) {
    if (at_end() || peek() != wanted) return false;
    ++position_;
    return true;
  }
  // Nothing if there is no digit; a number too large for any use here stays too large.
  std::optional<int> number() {
    if (!is_digit(peek())) return std::nullopt;
    int value = 0;
    for (; position_ < text_.size() && is_digit(text_[position_]); ++position_) {
      value = std::min(value * 10 + (text_[position_] - '0'), 100'000);
    }
    return value;
  }

  bool name(std::string_view& name) {
    const std::size_t colon = text_.find(':');
    if (colon == std::string_view::npos || text_.find(':', colon + 1) == std::string_view::npos) {
      return fail(What::no_name, text_.size());
    }
    std::size_t begin = 0;
    std::size_t end = colon;
    while (begin < end && is_space(text_[begin])) ++begin;
    while (begin < end && is_space(text_[end - 1])) --end;
    name = slice(text_, begin, end - begin);
    position_ = colon + 1;
    return true;
  }

  bool defaults() {
    while (!take(':')) {
      if (!one_default()) return false;
      if (!take(',') && peek() != ':') return fail(What::bad_default, position_);
    }
    return true;
  }

  bool one_default() {
    const char key = peek();
    const std::size_t begin = position_;
    if (std::string_view{"dobsl"}.find(key) == std::string_view::npos) {
      return fail(What::bad_default, begin);
    }
    ++position_;
    if (!take('=')) return fail(What::bad_default, begin);
    if (key == 's') return style();
    const std::size_t value_begin = next_position();
    const std::optional<int> value = number();
    return (value && set_default(key, *value)) || fail(What::bad_default_value, value_begin);
  }

  bool style() {
    const char letter = peek();
    if (letter != 'n' && letter != 'c' && letter != 's') {
      return fail(What::bad_default_value, position_);
    }
    ++position_;
    return true;
  }

  bool set_default(char key, int value) {
    switch (key) {
      case 'd': defaults_.division = value; return is_division(value);
      case 'o': defaults_.octave = value; return value >= 1 && value <= 9;
      case 'b':
        defaults_.beats_per_minute = value;
        return value >= 1 && value <= kMaxBeatsPerMinute;
      default: return true;  // l, the repetitions
    }
  }

  bool notes(Tune& notes) {
    do {
      if (at_end()) break;  // after a superfluous comma, which ring tones do have
      const std::size_t begin = next_position();
      Written written;
      if (!note(written)) return false;
      if (!sound(written, notes)) return fail(What::too_many_notes, begin);
    } while (take(','));
    if (!at_end()) return fail(What::unexpected, position_);
    return !notes.empty() || fail(What::no_notes, position_);
  }

  bool note(Written& written) {
    const std::size_t begin = next_position();
    written.division = number().value_or(defaults_.division);
    if (!is_division(written.division)) return fail(What::bad_duration, begin);
    const std::size_t letter_position = next_position();
    const char letter = peek() == 'h' ? 'b' : peek();
    const bool rest = letter == 'p';
    if (!rest && (letter < 'a' || letter > 'g')) return fail(What::bad_note, letter_position);
    ++position_;
    const bool sharp = !rest && take('#');
    const bool early_dot = take('.');
    const std::size_t octave_position = next_position();
    const std::optional<int> octave = number();
    written.dotted = early_dot || take('.');
    if (peek() == '.') return fail(What::second_dot, position_);
    if (rest) return true;
    const auto sounding = find_note(letter, sharp, octave.value_or(defaults_.octave));
    if (!sounding) return fail(What::out_of_range, octave ? octave_position : letter_position);
    written.number = *sounding;
    return true;
  }

  // Time is counted in a fraction of 1/64 s of which a dotted 1/64 note is a whole number at any
  // tempo: a beat is a quarter, so a whole note lasts 240 s / b.
  bool sound(const Written& written, Tune& notes) {
    const std::int64_t whole = std::int64_t{240} * 64 * 2 * kMaxDivision;
    const std::int64_t half = whole / written.division / 2;
    time_ += written.dotted ? 3 * half : 2 * half;
    const std::int64_t parts = std::int64_t{2} * kMaxDivision * defaults_.beats_per_minute;
    const std::int64_t end = (time_ + parts / 2) / parts;
    while (sounded_ < end) {
      const std::int64_t length = std::min<std::int64_t>(end - sounded_, kMaxNoteDuration);
      const Note note{written.number, SixtyFourths{static_cast<std::int32_t>(length)}};
      if (!notes.push_back(note)) return false;
      sounded_ += length;
    }
    return true;
  }

  std::string_view text_;
  std::size_t position_ = 0;
  Defaults defaults_{};
  std::int64_t time_ = 0;     // start of the next note, exact
  std::int64_t sounded_ = 0;  // the same in 1/64 s
  RtttlError error_{};
};

}  // namespace

std::string_view message(RtttlError::What what) {
  switch (what) {
    case What::no_name: return "a ring tone is name:defaults:notes, with two colons";
    case What::bad_default: return "defaults are d=, o= and b=, separated by commas";
    case What::bad_default_value:
      return "d is 1, 2, 4, 8, 16, 32 or 64, o is 1 to 9, b is 1 to 900, s is n, c or s";
    case What::bad_duration: return "a duration is 1, 2, 4, 8, 16, 32 or 64";
    case What::bad_note: return "a note is a to h, or p for a rest";
    case What::second_dot: return "a note has one dot, before or after its octave";
    case What::out_of_range: return "out of range: the robot plays g1 to g9";
    case What::unexpected: return "notes are separated by commas";
    case What::no_notes: return "there are no notes";
    case What::too_many_notes: return "too long: sixteen songs of sixteen notes hold 256";
  }
  return "not a ring tone";
}

std::optional<RtttlError> read_rtttl(std::string_view text, RingTone& tone) {
  RtttlReader reader{text};
  RingTone read;
  if (!reader.read(read)) return reader.error();
  tone = read;
  return std::nullopt;
}

}  // namespace cargobay::oi
