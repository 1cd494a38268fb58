#include "oi/text/command_text.hpp"

#include <algorithm>
#include <array>

#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/extensions.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/command_lexer.hpp"
#include "oi/text/nearest_name.hpp"
#include "oi/text/rtttl.hpp"
#include "oi/text/song.hpp"
#include "oi/text/text_number.hpp"
#include "oi/text/text_slice.hpp"
#include "oi/text/word_advice.hpp"

namespace cargobay::oi {
namespace {

using Code = TextError::Code;

// The manual writes some negative values as their bytes read without a sign: FF38, 251 for event
// -5, 255 for demo -1, 32768 for straight on. Accepted if nothing else could be meant.
std::int32_t with_sign(const ArgumentInfo& argument, std::int32_t number, bool hexadecimal) {
  if (!argument.is_signed) return number;
  const std::int32_t span = argument.size == 2 ? 0x10000 : 0x100;
  const bool unsigned_form = number >= span / 2 && number < span;
  const bool known = hexadecimal || argument.size == 1 ||
                     (number == span / 2 && argument.specials[0] == -span / 2);
  return unsigned_form && known ? number - span : number;
}

// For what is wrong with `bytes`, which makes no command of its own.
constexpr CommandInfo kRawBytes = [] {
  CommandInfo info = kCommandInfo<Script::kOpcode>;
  info.key = kRawBytesKey;
  return info;
}();

// For the slot of a tune, and for what is wrong with it: on the wire there are songs.
constexpr CommandInfo kTune = [] {
  CommandInfo info = kCommandInfo<Song::kOpcode>;
  info.key = kTuneKey;
  info.argument_count = 1;
  info.tail = Tail::none;
  return info;
}();

class Encoder {
 public:
  Encoder(std::string_view text, std::span<std::uint8_t> out, Beyond beyond)
      : lexer_{text}, out_{out}, beyond_{beyond} {}

  TextResult run() {
    advance();
    if (commands(nullptr) && word_.kind == Token::Kind::close) (void)fail(Code::stray_brace, word_);
    return error_ ? TextResult{.error = error_} : TextResult{.bytes = size_};
  }

 private:
  void advance() { word_ = lexer_.next(); }
  Token take() {
    const Token word = word_;
    advance();
    return word;
  }

  bool fail(Code code, const Token& at, const CommandInfo* command = nullptr,
            const ArgumentInfo* argument = nullptr, std::size_t limit = 0) {
    error_ = TextError{.code = code,
                       .position = at.position,
                       .length = at.text.size(),
                       .command = command,
                       .argument = argument,
                       .limit = limit};
    return false;
  }
  bool fail_with(const TextError& error, std::string_view advice, std::string_view hint) {
    error_ = error;
    error_->advice = advice;
    if (advice.empty()) error_->hint = hint;
    return false;
  }

  bool put(std::uint8_t byte, const Token& at) {
    if (size_ == out_.size()) return fail(Code::output_full, at, nullptr, nullptr, out_.size());
    out_[size_++] = byte;
    return true;
  }
  bool put_number(const ArgumentInfo& argument, std::int32_t value, const Token& at) {
    const auto raw = static_cast<std::uint32_t>(value);
    if (argument.size == 2 && !put(static_cast<std::uint8_t>(raw >> 8U), at)) return false;
    return put(static_cast<std::uint8_t>(raw), at);
  }

  // Up to the end or a closing brace. `around` is the entry of the enclosing script, or null.
  bool commands(const CommandInfo* around) {
    const std::size_t begin = size_;
    for (;;) {
      while (word_.kind == Token::Kind::separator) advance();
      if (word_.kind == Token::Kind::open) return fail(Code::stray_brace, word_);
      if (word_.kind != Token::Kind::word) return true;
      const Token key = take();
      if (!command(key, around)) return false;
      if (around != nullptr && size_ - begin > kMaxScriptBytes)
        return fail(Code::script_too_long, key, around, nullptr, kMaxScriptBytes);
    }
  }

  bool command(const Token& key, const CommandInfo* around) {
    if (key.text == kRawBytesKey) {
      const bool allowed = around != nullptr || beyond_ == Beyond::manual;
      return allowed ? raw_bytes() : fail(Code::bytes_outside, key);
    }
    if (key.text == kTuneKey) return tune();
    if (const ExtensionCommand* known = find_extension(key.text))
      return extension(key, *known, around != nullptr);
    if (key.text == kStopKey) return stop(key);
    const CommandInfo* info = kCreate.find_command(key.text);
    if (info == nullptr) return unknown(key);
    const bool whole =
        info->tail == Tail::script_bytes
            ? (around == nullptr ? script(key, *info) : fail(Code::nested_script, key, info))
            : plain(key, *info);
    return whole && is_complete(*info);
  }

  // Nothing follows its arguments.
  bool is_complete(const CommandInfo& info) {
    if (word_.kind == Token::Kind::word) return fail(Code::extra_argument, word_, &info);
    return word_.kind != Token::Kind::open || fail(Code::stray_brace, word_, &info);
  }

  bool stop(const Token& key) {
    constexpr std::array<std::uint8_t, 5> kBytes{DriveDirect::kOpcode};  // and both speeds 0
    for (const std::uint8_t byte : kBytes) {
      if (!put(byte, key)) return false;
    }
    if (word_.kind == Token::Kind::word) return fail(Code::extra_argument, word_);
    return word_.kind != Token::Kind::open || fail(Code::stray_brace, word_);
  }

  bool unknown(const Token& key) {
    NearestName nearest{key.text};
    nearest.consider(kStopKey);
    nearest.consider(kTuneKey);
    for (const CommandInfo& info : kCommands) {
      // In Full mode nothing stops the robot at a cliff.
      if (may_turn_wheels(info) || info.opcode == Full::kOpcode) {
        nearest.consider_misspelt(info.key);
      } else {
        nearest.consider(info.key);
      }
    }
    if (beyond_ == Beyond::manual) {
      nearest.consider_misspelt(kRawBytesKey);
      for (const ExtensionCommand& command : kExtensionCommands)
        nearest.consider_misspelt(command.info.key);
    }
    const std::string_view next = word_.kind == Token::Kind::word ? word_.text : "";
    return fail_with(
        {.code = Code::unknown_command, .position = key.position, .length = key.text.size()},
        command_advice(key.text, next), nearest.name());
  }

  bool plain(const Token& key, const CommandInfo& info) {
    const std::size_t count = info.argument_count - (info.tail == Tail::none ? 0U : 1U);
    std::array<std::int32_t, 4> values{};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = wire_place(info, i);
      const ArgumentInfo& argument = info.argument_slots[place];
      if (word_.kind != Token::Kind::word) return missing(info, argument);
      if (!value(info, argument, take(), values[place])) return false;
    }
    if (!put(info.opcode, key)) return false;
    for (std::size_t i = 0; i < count; ++i) {
      if (!put_number(info.argument_slots[i], values[i], key)) return false;
    }
    return info.tail == Tail::none || elements(key, info);
  }

  bool missing(const CommandInfo& info, const ArgumentInfo& argument) {
    return fail(Code::missing_argument, {word_.kind, {}, word_.position}, &info, &argument);
  }

  bool elements(const Token& key, const CommandInfo& info) {
    const std::size_t count_at = size_;
    if (!put(0, key)) return false;
    count_ = 0;
    if (info.tail == Tail::packet_ids && word_.kind == Token::Kind::word && word_.text == kNone) {
      advance();
      return true;
    }
    while (word_.kind == Token::Kind::word) {
      const Token word = take();
      if (!(info.tail == Tail::notes ? note(info, word) : packets(info, word))) return false;
    }
    if (count_ == 0) return missing(info, element_arguments(info.tail)[0]);
    out_[count_at] = static_cast<std::uint8_t>(count_);
    return true;
  }

  bool one_more(const CommandInfo& info, const Token& word) {
    const auto most = static_cast<std::size_t>(info.arguments().back().max);
    if (count_ == most) return fail(Code::too_many, word, &info, &info.arguments().back(), most);
    ++count_;
    return true;
  }

  bool element_value(const CommandInfo& info, const ArgumentInfo& argument, const Token& word) {
    std::int32_t number = 0;
    return value(info, argument, word, number) && put_number(argument, number, word);
  }

  // One packet, or several separated by commas.
  bool packets(const CommandInfo& info, const Token& word) {
    for (std::size_t begin = 0; begin < word.text.size();) {
      const std::size_t comma = std::min(word.text.find(',', begin), word.text.size());
      const Token part = word.part(begin, comma - begin);
      if (!one_more(info, part)) return false;
      if (!element_value(info, element_arguments(info.tail)[0], part)) return false;
      begin = comma + 1;
    }
    return true;
  }

  bool note(const CommandInfo& info, const Token& word) {
    const std::size_t colon = word.text.find(':');
    const std::span<const ArgumentInfo> arguments = element_arguments(info.tail);
    if (colon == std::string_view::npos) return fail(Code::bad_note, word, &info);
    if (!one_more(info, word)) return false;
    const Token pitch = word.part(0, colon);
    const std::optional<std::uint8_t> named = find_note(pitch.text);
    return (named ? put(*named, pitch) : element_value(info, arguments[0], pitch)) &&
           element_value(info, arguments[1], word.part(colon + 1, std::string_view::npos));
  }

  bool value(const CommandInfo& info, const ArgumentInfo& argument, const Token& word,
             std::int32_t& out) {
    if (is_bit_set(argument) && bits(argument, word.text, out)) return true;
    if (const auto named = named_value(argument, word.text); named && !is_bit_set(argument)) {
      out = *named;
      return true;
    }
    const std::optional<std::int32_t> number = parse_integer(word.text);
    if (!number) return bad_value(info, argument, word);
    out = with_sign(argument, *number, word.text.starts_with("0x") || word.text.starts_with("0X"));
    return argument.accepts(out) || fail(Code::out_of_range, word, &info, &argument);
  }

  static bool bits(const ArgumentInfo& argument, std::string_view text, std::int32_t& out) {
    out = 0;
    if (text == kNone) return true;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t comma = std::min(text.find(',', begin), text.size());
      const auto bit = named_value(argument, slice(text, begin, comma - begin));
      if (!bit) return false;
      out |= *bit;
      begin = comma + 1;
    }
    return true;
  }

  bool bad_value(const CommandInfo& info, const ArgumentInfo& argument, const Token& word) {
    NearestName nearest{word.text};
    const bool moves = argument.name == "demo" || argument.name == "radius";
    // A rate is digits: none of them resembles a word.
    if (argument.name != "code") {
      for (const ValueName& name : value_names(argument)) {
        if (moves) {
          nearest.consider_misspelt(name.name);
        } else {
          nearest.consider(name.name);
        }
      }
    }
    return fail_with({.code = Code::bad_value,
                      .position = word.position,
                      .length = word.text.size(),
                      .command = &info,
                      .argument = &argument},
                     value_advice(argument, word.text), nearest.name());
  }

  bool script(const Token& key, const CommandInfo& info) {
    if (word_.kind != Token::Kind::open)
      return fail(Code::no_script, {word_.kind, {}, word_.position}, &info);
    const Token brace = take();
    if (!put(info.opcode, key) || !put(0, key)) return false;
    const std::size_t begin = size_;
    if (!commands(&info)) return false;
    if (word_.kind != Token::Kind::close) return fail(Code::open_script, brace, &info);
    advance();
    out_[begin - 1] = static_cast<std::uint8_t>(size_ - begin);
    return true;
  }

  bool raw_bytes() {
    const ArgumentInfo& byte = element_arguments(kRawBytes.tail)[0];
    if (word_.kind != Token::Kind::word) return missing(kRawBytes, byte);
    while (word_.kind == Token::Kind::word) {
      if (!element_value(kRawBytes, byte, take())) return false;
    }
    return true;
  }

  bool extension(const Token& key, const ExtensionCommand& command, bool in_script) {
    if (beyond_ == Beyond::nothing || in_script) return fail(Code::extension, key);
    if (!put(command.opcode, key)) return false;
    return word_.kind != Token::Kind::word || fail(Code::extra_argument, word_, &command.info);
  }

  bool tune() {
    const ArgumentInfo& slot_info = kTune.argument_slots[0];
    if (word_.kind != Token::Kind::word) return missing(kTune, slot_info);
    std::int32_t slot = 0;
    if (!value(kTune, slot_info, take(), slot)) return false;
    if (word_.kind != Token::Kind::word)
      return fail(Code::no_tune, {word_.kind, {}, word_.position}, &kTune);
    const Token text = lexer_.rest_of_command(word_);
    advance();
    RingTone tone;
    if (const auto wrong = read_rtttl(text.text, tone)) {
      const Token at = text.part(wrong->column - 1, 1);
      return fail_with({.code = Code::bad_tune,
                        .position = at.position,
                        .length = at.text.size(),
                        .command = &kTune},
                       {}, message(wrong->what));
    }
    const auto songs = split(tone.notes, static_cast<std::uint8_t>(slot));
    if (!songs) {
      const std::size_t room = kMaxSongNotes * (kSongSlots - static_cast<std::size_t>(slot));
      return fail(Code::tune_too_long, text, &kTune, nullptr, room);
    }
    return std::ranges::all_of(*songs, [&](const Song& song) {
      const auto bytes = oi::encode(song);  // the notes are in their ranges
      return std::ranges::all_of(*bytes, [&](std::uint8_t byte) { return put(byte, text); });
    });
  }

  CommandLexer lexer_;
  Token word_{};  // the next one
  std::span<std::uint8_t> out_;
  Beyond beyond_;
  std::size_t size_ = 0;
  std::size_t count_ = 0;  // elements of the tail so far
  std::optional<TextError> error_{};
};

}  // namespace

TextResult encode_text(std::string_view text, std::span<std::uint8_t> out, Beyond beyond) {
  return Encoder{text, out, beyond}.run();
}

std::size_t most_bytes(std::string_view text) {
  // Every command but a tune and `stop` has more characters than bytes; that has one less.
  constexpr std::size_t kTuneBytes = kSongSlots * (3 + 2 * kMaxSongNotes);
  std::size_t bytes = text.size() + 1;
  for (std::size_t at = text.find(kTuneKey); at < text.size(); at = text.find(kTuneKey, at + 1))
    bytes += kTuneBytes;
  return bytes;
}

}  // namespace cargobay::oi
