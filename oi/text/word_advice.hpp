// What does here what people ask for in words of other robots and of every day.
//
// A robot must not be set in motion by a helpful guess: `stop` is near to `spot`, which drives. So
// these words are answered by what they mean, and names of motion are only suggested for what is
// their misspelling.
#pragma once

#include <string_view>

#include "oi/command_table.hpp"

namespace cargobay::oi {

// Stops the wheels: `drive_direct 0 0`. A word of the text form, and no command of the manual.
inline constexpr std::string_view kStopKey = "stop";

// Whether the command sets the wheels turning, at once or by a demo or a script.
constexpr bool may_turn_wheels(const CommandInfo& info) {
  switch (info.opcode) {
    case 134:               // Spot
    case 135:               // Cover
    case 136:               // Demo
    case 137:               // Drive
    case 143:               // Cover and Dock
    case 145:               // Drive Direct
    case 153: return true;  // Play Script
    default: return false;
  }
}

// For a word in place of a command: "to stop the wheels, write: stop". Empty if nothing is known
// about the word.
std::string_view command_advice(std::string_view word);
// The same for a word and the one after it, which may be empty: power off, go home.
std::string_view command_advice(std::string_view word, std::string_view next);
// The same for a word in place of a value of this argument.
std::string_view value_advice(const ArgumentInfo& argument, std::string_view word);

}  // namespace cargobay::oi
