// Scripts (OI p. 15) as text and back: one command per line, in the words of
// oi/text/command_text.hpp.
//
//   # forward 40 cm, then stop
//   drive 300 straight
//   wait_distance 400; drive_direct 0 0
//
// `;` separates like a new line; `#` at the beginning of a word begins a comment. One kind of line
// is not a command: `bytes 137 1` gives these bytes, whatever they are. With it, a stored script
// can be written down even if it is not a whole sequence of valid commands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "oi/commands.hpp"
#include "oi/fixed_list.hpp"
#include "oi/limits.hpp"
#include "oi/script_builder.hpp"
#include "oi/text/command_text.hpp"

namespace cargobay::oi {

struct ScriptTextError {
  enum class What : std::uint8_t {
    command,        // not a command, or not its arguments: `command` says more
    bytes,          // no number from 0 to 255 after `bytes`
    nested_script,  // a script cannot store another
    too_long,       // the command is the first that does not fit into 100 bytes
  };
  What what = What::command;
  std::size_t line = 1;    // of the wrong word; line and column from 1,
  std::size_t column = 1;  // columns in bytes
  TextError command{};     // What::command; its position is in the whole text
  std::size_t excess = 0;  // What::too_long: how many bytes the whole script is over
};

// Fills `script`, or leaves it alone and returns what is wrong. A text without a command makes the
// empty script, which clears the stored one.
std::optional<ScriptTextError> compile(std::string_view text, Script& script);

// No command's text, new line included, is longer than this for each of its bytes.
inline constexpr std::size_t kMaxTextPerScriptByte = 30;
using ScriptText = FixedList<char, kMaxScriptBytes * kMaxTextPerScriptByte>;

// The script as text, one line per command; compile() turns it into the same bytes, whatever they
// are. They are divided as the robot divides them: a known opcode with a value out of range takes
// its arguments with it.
ScriptText disassemble(const Script& script);

// One line for a user, without a new line: where, what is wrong, and what would be right. Return
// the characters written, at most as many as there is room for; 400 suffice.
std::size_t format_error(const ScriptTextError& error, std::string_view text, std::span<char> out);
std::size_t format_error(const ScriptBuilder::Error& error, std::span<char> out);

}  // namespace cargobay::oi
