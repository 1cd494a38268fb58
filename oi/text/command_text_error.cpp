// What is wrong with a text of commands, in words: format_error().
#include <algorithm>

#include "oi/text/argument_names.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/text_slice.hpp"

namespace cargobay::oi {
namespace {

using Code = TextError::Code;

// `column 7: `, after `line 2, ` if there are several lines. Both count from 1.
void write_place(TextWriter& out, std::string_view text, std::size_t position) {
  position = std::min(position, text.size());
  const std::string_view before = slice(text, 0, position);
  const std::size_t line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t line_begin = line == 0 ? 0 : before.rfind('\n') + 1;
  if (text.find('\n') < text.size()) {
    out.put("line ");
    out.put_number(static_cast<std::int64_t>(line + 1));
    out.put(", ");
  }
  out.put("column ");
  out.put_number(static_cast<std::int64_t>(position - line_begin + 1));
  out.put(": ");
}

// A word as it was written, as far as it can be printed on a line.
void write_word(TextWriter& out, std::string_view word) {
  constexpr std::size_t kMost = 40;
  out.put("'");
  for (const char c : slice(word, 0, kMost)) {
    const bool printable = c >= 0x20 && c < 0x7f;
    out.put(printable ? std::string_view{&c, 1} : "?");
  }
  out.put(word.size() > kMost ? "...'" : "'");
}

// `velocity and radius`, in the order of the text; `no arguments`.
void write_arguments(TextWriter& out, const CommandInfo& info) {
  if (info.argument_count == 0) out.put("no arguments");
  for (std::size_t i = 0; i < info.argument_count; ++i) {
    if (i > 0) out.put(i + 1U == info.argument_count ? " and " : ", ");
    out.put(info.argument_slots[wire_place(info, i)].name);
  }
}

void write_about_argument(TextWriter& out, const TextError& error, std::string_view word) {
  const ArgumentInfo& argument = *error.argument;
  out.put(argument.name);
  if (error.code != Code::missing_argument) {
    out.put(" ");
    write_word(out, word);
  }
  switch (error.code) {
    case Code::missing_argument: out.put(" is missing"); break;
    case Code::out_of_range: out.put(" is out of range"); break;
    default:
      out.put(value_names(argument).empty() ? " is not a number"
                                            : " is neither a number nor a name it knows");
      break;
  }
  if (!error.advice.empty()) {
    out.put("; ");
    return out.put(error.advice);
  }
  if (!error.hint.empty()) {
    out.put("; did you mean '");
    out.put(error.hint);
    out.put("'? It");
  } else {
    out.put("; it");
  }
  out.put(" is ");
  write_choice(out, argument);
  if (argument.name == "packet" && error.command != nullptr && error.command->tail != Tail::none)
    out.put(", or none");
}

void write_extra(TextWriter& out, const TextError& error, std::string_view word) {
  write_word(out, word);
  if (error.command == nullptr) {
    out.put(" is too much: stop takes no arguments");
  } else if (error.command->tail == Tail::script_bytes) {
    out.put(" follows the script");
  } else {
    out.put(" is too much: it takes ");
    write_arguments(out, *error.command);
  }
  out.put("; separate commands with ;");
}

void write_limit(TextWriter& out, std::string_view before, const TextError& error,
                 std::string_view after) {
  out.put(before);
  out.put_number(static_cast<std::int64_t>(error.limit));
  out.put(after);
}

void write_unknown(TextWriter& out, const TextError& error, std::string_view word) {
  write_word(out, word);
  out.put(" is not a command");
  if (!error.advice.empty()) {
    out.put("; ");
    return out.put(error.advice);
  }
  if (error.hint.empty()) return;
  out.put("; did you mean '");
  out.put(error.hint);
  out.put("'?");
}

void write_what(TextWriter& out, const TextError& error, std::string_view word) {
  if (error.command != nullptr) {
    out.put(error.command->key);
    out.put(": ");
  }
  switch (error.code) {
    case Code::unknown_command: return write_unknown(out, error, word);
    case Code::missing_argument:
    case Code::bad_value:
    case Code::out_of_range: return write_about_argument(out, error, word);
    case Code::extra_argument: return write_extra(out, error, word);
    case Code::bad_note:
      write_word(out, word);
      return out.put(" is not a note; write note:duration, such as 60:32, c4:32 or rest:16");
    case Code::too_many:
      return write_limit(out, "more than ", error,
                         error.command->tail == Tail::notes ? " notes" : " packets");
    case Code::no_script:
      return out.put("its commands go in braces: script { drive 300 straight; drive 0 0 }");
    case Code::open_script: return out.put("this brace is not closed");
    case Code::stray_brace: return out.put("a brace is not allowed here; only a script has braces");
    case Code::nested_script: return out.put("a script cannot hold a script");
    case Code::script_too_long:
      return write_limit(out, "from here on it is longer than ", error, " bytes");
    case Code::bytes_outside: return out.put("'bytes' is allowed in a script only");
    case Code::extension:
      write_word(out, word);
      return out.put(" is not in the manual: only some robots know it, and not in a script");
    case Code::no_tune:
      return out.put("the ring tone is missing; write: tune 0 name:d=4,o=5,b=120:8c,8e_,g.");
    case Code::bad_tune: return out.put(error.hint);
    case Code::tune_too_long:
      return write_limit(out, "too long: the slots from this one on hold ", error, " notes");
    case Code::output_full:
      return write_limit(out, "the commands make more than ", error, " bytes");
  }
}

}  // namespace

std::size_t format_error(const TextError& error, std::string_view text, std::span<char> out) {
  TextWriter writer{out};
  write_place(writer, text, error.position);
  const std::size_t begin = std::min(error.position, text.size());
  write_what(writer, error, slice(text, begin, error.length));
  return writer.size();
}

}  // namespace cargobay::oi
