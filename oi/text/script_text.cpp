#include "oi/text/script_text.hpp"

#include <algorithm>
#include <array>

#include "oi/command_table.hpp"
#include "oi/parse.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/command_lexer.hpp"
#include "oi/text/text_number.hpp"
#include "oi/text/text_slice.hpp"
#include "oi/text/text_writer.hpp"

namespace cargobay::oi {
namespace {

using Wrong = ScriptTextError::What;

class Compiler {
 public:
  explicit Compiler(std::string_view text) : text_{text} {}

  bool compile() {
    CommandLexer lexer{text_};
    for (Token word = lexer.next(); word.kind != Token::Kind::end; word = lexer.next()) {
      if (word.kind != Token::Kind::separator && !command(lexer, word)) return false;
    }
    if (!overflow_) return true;
    error_.excess = size_ - kMaxScriptBytes;
    return fail(Wrong::too_long, *overflow_);
  }
  const ScriptTextError& error() const { return error_; }
  const Script& script() const { return script_; }

 private:
  bool fail(Wrong what, std::size_t position) {
    const std::string_view before = slice(text_, 0, position);
    error_.what = what;
    error_.line = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    error_.column = position - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
    return false;
  }

  // Takes the words from the first one to the separator.
  bool command(CommandLexer& lexer, const Token& first) {
    if (first.text == kRawBytesKey) return bytes(lexer, first);
    if (first.text == kCommandInfo<Script::kOpcode>.key) {
      return fail(Wrong::nested_script, first.position);
    }
    Token last = first;
    Token word = lexer.next();
    if (first.text == kTuneKey && in_command(word)) {
      last = word;  // the slot
      word = lexer.next();
      if (in_command(word)) word = lexer.rest_of_command(word);
    }
    for (; in_command(word); word = lexer.next()) last = word;
    const std::size_t end = last.position + last.text.size();
    std::array<std::uint8_t, kMaxCommandBytes> encoded{};
    TextResult result = encode_text(slice(text_, first.position, end - first.position), encoded);
    if (result.error) {
      result.error->position += first.position;
      error_.command = *result.error;
      return fail(Wrong::command, result.error->position);
    }
    append(first.position, std::span{encoded}.first(result.bytes));
    return true;
  }
  static bool in_command(const Token& word) {
    return word.kind != Token::Kind::separator && word.kind != Token::Kind::end;
  }

  bool bytes(CommandLexer& lexer, const Token& first) {
    Token word = lexer.next();
    if (!in_command(word)) return fail(Wrong::bytes, first.position);
    for (; in_command(word); word = lexer.next()) {
      const std::optional<std::int32_t> number = parse_integer(word.text);
      if (!number || *number < 0 || *number > 255) return fail(Wrong::bytes, word.position);
      const auto byte = static_cast<std::uint8_t>(*number);
      append(first.position, std::span{&byte, 1});
    }
    return true;
  }

  void append(std::size_t position, std::span<const std::uint8_t> bytes) {
    size_ += bytes.size();
    if (overflow_ || script_.body.append(bytes)) return;
    overflow_ = position;
  }

  std::string_view text_;
  Script script_{};
  std::size_t size_ = 0;                 // of all commands, including those that do not fit
  std::optional<std::size_t> overflow_;  // the position of the first of these
  ScriptTextError error_{};
};

// The bytes at the beginning that the robot takes as one command.
struct Piece {
  std::size_t length = 0;
  bool is_command = false;  // one that a script may hold
};

Piece first_piece(std::span<const std::uint8_t> bytes) {
  const ParseResult result = parse_command(bytes);
  return {
      .length = result.length != 0 ? result.length : bytes.size(),
      .is_command = result.outcome == ParseResult::Outcome::command && bytes[0] != Script::kOpcode};
}

// Returns the characters written. `out` has room for kMaxTextPerScriptByte for each byte.
std::size_t write_line(const Piece& piece, std::span<const std::uint8_t> bytes,
                       std::span<char> out) {
  if (piece.is_command) {
    const std::size_t size = format_command(bytes, out.first(out.size() - 1));
    if (size != 0) {
      out[size] = '\n';
      return size + 1;
    }
  }
  TextWriter line{out};
  line.put(kRawBytesKey);
  for (const std::uint8_t byte : bytes) {
    line.put(" ");
    line.put_number(byte);
  }
  line.put("\n");
  return line.size();
}

void put_count(TextWriter& line, std::size_t count) {
  line.put_number(static_cast<std::int64_t>(count));
}

// The line only if there are several, as in oi/text/command_text.hpp.
void put_place(TextWriter& line, const ScriptTextError& error, std::string_view text) {
  if (text.find('\n') != std::string_view::npos) {
    line.put("line ");
    put_count(line, error.line);
    line.put(", ");
  }
  line.put("column ");
  put_count(line, error.column);
  line.put(": ");
}

void put_range(TextWriter& line, const ArgumentInfo& argument, std::int32_t value) {
  line.put(argument.name);
  line.put(" ");
  line.put_number(value);
  line.put(" is out of range; it is ");
  write_choice(line, argument);
}

void put_excess(TextWriter& line, std::size_t excess) {
  line.put("from here on it is longer than ");
  put_count(line, kMaxScriptBytes);
  line.put(" bytes, in all by ");
  put_count(line, excess);
}

constexpr std::string_view kNestedScript = "a script cannot hold a script";

}  // namespace

std::optional<ScriptTextError> compile(std::string_view text, Script& script) {
  Compiler compiler{text};
  if (!compiler.compile()) return compiler.error();
  script = compiler.script();
  return std::nullopt;
}

ScriptText disassemble(const Script& script) {
  ScriptText text;
  std::array<char, ScriptText::capacity()> line{};
  std::span<const std::uint8_t> rest{script.body};
  while (!rest.empty()) {
    const Piece piece = first_piece(rest);
    const std::span room = std::span{line}.first(piece.length * kMaxTextPerScriptByte);
    const std::size_t size = write_line(piece, rest.first(piece.length), room);
    (void)text.append(room.first(size));  // fits: no byte takes more than its share of the room
    rest = rest.subspan(piece.length);
  }
  return text;
}

std::size_t format_error(const ScriptTextError& error, std::string_view text, std::span<char> out) {
  if (error.what == Wrong::command) return format_error(error.command, text, out);
  TextWriter line{out};
  put_place(line, error, text);
  switch (error.what) {
    case Wrong::command: break;
    case Wrong::bytes: line.put("bytes are numbers, 0 to 255"); break;
    case Wrong::nested_script: line.put(kNestedScript); break;
    case Wrong::too_long: put_excess(line, error.excess); break;
  }
  return line.size();
}

std::size_t format_error(const ScriptBuilder::Error& error, std::span<char> out) {
  TextWriter line{out};
  line.put("command ");
  put_count(line, error.index + 1);
  if (error.command != nullptr) {
    line.put(", ");
    line.put(error.command->key);
  }
  line.put(": ");
  switch (error.what) {
    case ScriptBuilder::Error::What::out_of_range:
      if (error.argument != nullptr) put_range(line, *error.argument, error.value);
      break;
    case ScriptBuilder::Error::What::too_long: put_excess(line, error.excess); break;
    case ScriptBuilder::Error::What::nested_script: line.put(kNestedScript); break;
  }
  return line.size();
}

}  // namespace cargobay::oi
