#include "oi/text/rtttl.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "oi/text/lower.hpp"
#include "oi/text/text_slice.hpp"

namespace cargobay::oi {
namespace {

using What = RtttlError::What;

constexpr int kMaxBeatsPerMinute = 900;
constexpr int kMaxDivision = 64;  // a 1/64 note is the shortest
constexpr std::string_view kBpm = "bpm";

constexpr bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return lower(c) >= 'a' && lower(c) <= 'z'; }

constexpr bool is_division(int number) { return number >= 1 && kMaxDivision % number == 0; }

// One note as written.
struct Written {
  int division = 4;  // 1/division of a whole note
  bool dotted = false;
  char letter = 'c';
  int semitones = 0;  // 1 for a sharp, -1 for a flat
  std::optional<int> octave{};
  std::uint8_t number = kRest;
};

std::optional<std::uint8_t> find_note(const Written& written, int octave) {
  if (octave > 9) return std::nullopt;
  const char accidental = written.semitones > 0 ? '#' : 'b';
  const std::array name{written.letter, accidental, static_cast<char>('0' + octave)};
  const std::array natural{written.letter, name.back()};
  return written.semitones != 0 ? oi::find_note({name.data(), name.size()})
                                : oi::find_note({natural.data(), natural.size()});
}

// What a control sets, by its first letter; 0 for a control that is not known.
char control_key(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, char>, 9> kNames{{{"d", 'd'},
                                                                     {"duration", 'd'},
                                                                     {"o", 'o'},
                                                                     {"octave", 'o'},
                                                                     {"b", 'b'},
                                                                     {"bpm", 'b'},
                                                                     {"tempo", 'b'},
                                                                     {"s", 's'},
                                                                     {"l", 'l'}}};
  const auto* const found = std::ranges::find_if(kNames, [name](const auto& entry) {
    return std::ranges::equal(name, entry.first, {}, lower);
  });
  return found == kNames.end() ? '\0' : found->second;
}

class RtttlReader {
 public:
  explicit RtttlReader(std::string_view text) : text_{text} {}

  bool read(RingTone& tone) {
    return sections(tone.name) && (notes_only_ || controls()) && notes(tone.notes);
  }
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
  bool take_sharp() { return take('#') || take('_'); }
  // Nothing if there is no digit; a number too large for any use here stays too large.
  std::optional<int> number() {
    if (!is_digit(peek())) return std::nullopt;
    int value = 0;
    for (; position_ < text_.size() && is_digit(text_[position_]); ++position_) {
      value = std::min(value * 10 + (text_[position_] - '0'), 100'000);
    }
    return value;
  }
  std::string_view word() {
    const std::size_t begin = next_position();
    while (position_ < text_.size() && is_letter(text_[position_])) ++position_;
    return slice(text_, begin, position_ - begin);
  }

  // The end of the section that begins here: its colon, or the end of the text.
  std::size_t section_end(std::size_t begin) const {
    return std::min(text_.find(':', begin), text_.size());
  }
  // `d=4`.
  bool begins_with_control(std::size_t begin) {
    position_ = begin;
    return !word().empty() && take('=');
  }
  // The same, or between two colons also `d4`, a style, or nothing.
  bool is_controls(std::size_t begin) {
    if (begins_with_control(begin)) return true;
    if (section_end(begin) == text_.size()) return false;
    position_ = begin;
    const std::string_view name = word();
    if (name.empty()) return peek() == ':';
    return is_style(name) || (name.size() == 1 && is_digit(peek()));
  }

  // Divides the text: takes the name, and goes to what follows it. The name may have colons too;
  // the first section of controls ends it.
  bool sections(std::string_view& name) {
    const std::size_t colon = section_end(0);
    if (colon == text_.size()) return fail(What::no_colon, colon);
    std::size_t begin = 0;
    const bool more = section_end(colon + 1) < text_.size();
    const bool named = more ? !begins_with_control(0) || is_controls(colon + 1)
                            : slice(text_, 0, colon).find('=') == std::string_view::npos;
    if (named) {
      begin = colon + 1;
      for (std::size_t next = begin; next <= text_.size(); next = section_end(next) + 1) {
        if (!is_controls(next)) continue;
        begin = next;
        break;
      }
      name = trimmed(slice(text_, 0, begin - 1));
    }
    notes_only_ = section_end(begin) == text_.size();
    position_ = begin;
    return true;
  }
  static std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
  }

  bool controls() {
    while (!take(':')) {
      if (!control()) return false;
      (void)take(',');  // often left out
    }
    return true;
  }

  // Whether a control begins here, among the notes: any with `=`, an octave, a style.
  bool control_is_next() {
    const std::size_t begin = next_position();
    const std::string_view name = word();
    const bool octave = name.size() == 1 && lower(name[0]) == 'o';
    const bool is = !name.empty() && (take('=') || octave || is_style(name));
    position_ = begin;
    return is;
  }
  static bool is_style(std::string_view name) {
    return name.size() == 2 && lower(name[0]) == 's' &&
           std::string_view{"ncs"}.find(lower(name[1])) != std::string_view::npos;
  }

  // `d=4`, and as the specification of RTTTL has it also `d4`; `ss` for the style.
  bool control() {
    const std::size_t begin = next_position();
    const std::string_view name = word();
    if (name.empty()) return fail(What::bad_default, begin);
    const bool style = is_style(name) && peek() != '=';
    if (style) position_ = begin + 1;
    const char key = style ? 's' : control_key(name);
    if (!style && !take('=') && (key == '\0' || !is_digit(peek())))
      return fail(What::bad_default, begin);
    return control_value(key);
  }

  bool control_value(char key) {
    const std::size_t begin = next_position();
    if (key == '\0') {
      while (position_ < text_.size() && text_[position_] != ',' && text_[position_] != ':')
        ++position_;
      return true;
    }
    if (key == 's') {
      const bool known = std::string_view{"ncs"}.find(peek()) != std::string_view::npos;
      if (!known) return fail(What::bad_default_value, begin);
      ++position_;
      return true;
    }
    const std::optional<int> value = number();
    if (!value || !set_default(key, *value)) return fail(What::bad_default_value, begin);
    if (peek() == '.') return fail(What::bad_default_value, position_);  // b=112.5
    if (key == 'b' && std::ranges::equal(slice(text_, next_position(), 3), kBpm, {}, lower))
      position_ += kBpm.size();
    return true;
  }

  bool set_default(char key, int value) {
    switch (key) {
      case 'd': division_ = value; return is_division(value);
      case 'o': octave_ = value; return value >= 1 && value <= 9;
      case 'b':
        if (value < 1 || value > kMaxBeatsPerMinute) return false;
        set_tempo(value);
        return true;
      default: return true;  // l, the repetitions
    }
  }

  bool notes(Tune& notes) {
    do {
      if (at_end()) break;  // after a superfluous comma, which ring tones do have
      const std::size_t begin = next_position();
      if (control_is_next()) {
        if (!control()) return false;
        continue;
      }
      Written written;
      if (!note(written)) return false;
      if (!sound(written, notes)) return fail(What::too_many_notes, begin);
    } while (take(','));
    if (!at_end()) return fail(What::unexpected, position_);
    return !notes.empty() || fail(What::no_notes, position_);
  }

  // A duration, letter and octave; a dot after any of them, a sharp on either side of the letter.
  bool note(Written& written) {
    const std::size_t begin = next_position();
    written.division = number().value_or(division_);
    if (!is_division(written.division)) return fail(What::bad_duration, begin);
    if (!dot(written)) return false;
    if (take_sharp()) written.semitones = 1;
    const std::size_t letter_position = next_position();
    const char letter = peek();
    const bool rest = (letter == 'p' || letter == 'r') && written.semitones == 0;
    written.letter = letter == 'h' ? 'b' : letter;
    if (!rest && (written.letter < 'a' || written.letter > 'g'))
      return fail(What::bad_note, letter_position);
    ++position_;
    if (!rest && written.semitones == 0) accidental(written);
    if (!dot(written)) return false;
    const std::size_t octave_position = next_position();
    const std::optional<int> octave = number();
    if (!rest && octave && written.semitones == 0 && take_sharp()) written.semitones = 1;
    if (!dot(written) || !no_dot()) return false;
    if (rest) return true;
    const auto sounding = find_note(written, octave.value_or(octave_));
    if (!sounding) return fail(What::out_of_range, octave ? octave_position : letter_position);
    written.number = *sounding;
    return true;
  }

  void accidental(Written& written) {
    if (take_sharp()) written.semitones = 1;
    if (written.semitones == 0 && take('b')) written.semitones = -1;
  }
  bool dot(Written& written) {
    if (written.dotted) return no_dot();
    written.dotted = take('.');
    return !written.dotted || no_dot();
  }
  bool no_dot() { return peek() != '.' || fail(What::second_dot, position_); }

  // A beat is a quarter, so a whole note lasts 240 s / b. The time since the last change of tempo
  // is counted in parts_ of 1/64 s, of which a dotted 1/64 note is a whole number.
  bool sound(const Written& written, Tune& notes) {
    constexpr std::int64_t kWhole = std::int64_t{240} * 64 * 2 * kMaxDivision;
    const std::int64_t half = kWhole / written.division / 2;
    time_ += written.dotted ? 3 * half : 2 * half;
    const std::int64_t end = (now() + kFine / 2 + kRoundingErrors) / kFine;
    while (sounded_ < end) {
      const std::int64_t length = std::min<std::int64_t>(end - sounded_, kMaxNoteDuration);
      const Note note{written.number, SixtyFourths{static_cast<std::int32_t>(length)}};
      if (!notes.push_back(note)) return false;
      sounded_ += length;
    }
    return true;
  }
  void set_tempo(int beats_per_minute) {
    base_ = now();
    time_ = 0;
    parts_ = std::int64_t{2} * kMaxDivision * beats_per_minute;
  }
  // The start of the next note in kFine of 1/64 s. No product overflows: a tune lasts at most 65280
  // of them, which are 7.6e9 parts.
  std::int64_t now() const { return base_ + (time_ * kFine + parts_ / 2) / parts_; }

  static constexpr std::int64_t kFine = std::int64_t{1} << 28;
  static constexpr std::int64_t kRoundingErrors = 64;  // of as many changes of tempo

  std::string_view text_;
  std::size_t position_ = 0;
  bool notes_only_ = false;  // there is no section of controls
  int division_ = 4;
  int octave_ = 6;
  std::int64_t parts_ = std::int64_t{2} * kMaxDivision * 63;
  std::int64_t base_ = 0;     // start of the first note of this tempo
  std::int64_t time_ = 0;     // since then
  std::int64_t sounded_ = 0;  // end of the last note, in 1/64 s
  RtttlError error_{};
};

}  // namespace

std::string_view message(RtttlError::What what) {
  switch (what) {
    case What::no_colon: return "a ring tone is name:defaults:notes, with colons between";
    case What::bad_default: return "defaults are d=, o= and b=, separated by commas";
    case What::bad_default_value:
      return "d is 1, 2, 4, 8, 16, 32 or 64, o is 1 to 9, b is a whole number from 1 to 900, s is "
             "n, c or s";
    case What::bad_duration: return "a duration is 1, 2, 4, 8, 16, 32 or 64";
    case What::bad_note: return "a note is a to h, or p for a rest";
    case What::second_dot: return "a note has one dot";
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
