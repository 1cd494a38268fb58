// Scripts (OI p. 15) as text and back: one command a line, in the words of
// oi/text/command_text.hpp.
//
//   # forward 40 cm, then stop
//   drive 300 straight
//   wait_distance 400; drive_direct 0 0
//
// `;` separates as a new line does; `#` at the beginning of a word begins a comment. One line is
// no command: `bytes 137 1` stands for these bytes, whatever they are. It is how a stored script
// that is no whole sequence of valid commands is written down.
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
    bytes,          // behind `bytes` stands no number from 0 to 255
    nested_script,  // a script cannot store another
    too_long,       // the command is the first that does not fit into 100 bytes
  };
  What what = What::command;
  std::size_t line = 1;    // of the word that is wrong; both from 1,
  std::size_t column = 1;  // columns in bytes
  TextError command{};     // What::command; its position is in the whole text
  std::size_t excess = 0;  // What::too_long: so many bytes of the whole script
};

// Fills `script`, or leaves it alone and says what is wrong. A text without a command makes the
// empty script, which clears the stored one.
std::optional<ScriptTextError> compile(std::string_view text, Script& script);

// No command's text is longer than this, its new line included, for each of its bytes.
inline constexpr std::size_t kMaxTextPerScriptByte = 30;
using ScriptText = FixedList<char, kMaxScriptBytes * kMaxTextPerScriptByte>;

// The script as text, a line for each command; compile() turns it into the same bytes, whatever
// they are. They are divided as the robot divides them: a known opcode with a value out of range
// takes its arguments along.
ScriptText disassemble(const Script& script);

// One line for a person, without a new line: where, what is wrong, and what would be right. Return
// the characters written, at most as many as there is room for; 400 suffice.
std::size_t format_error(const ScriptTextError& error, std::string_view text, std::span<char> out);
std::size_t format_error(const ScriptBuilder::Error& error, std::span<char> out);

}  // namespace cargobay::oi
