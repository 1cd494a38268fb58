// The operands that follow a command's options: commands as text, bytes as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/file/read_input.hpp"
#include "hal/result.hpp"
#include "oi/text/command_text.hpp"

namespace CLI {
class App;
}

namespace cargobay::cli {

// Lets the command take operands that look like options, such as -200. `name` is for its help.
void take_operands(CLI::App& command, const std::string& name, const std::string& description);
// The operands joined by spaces; standard input if there are none, or for `-`. Fails if standard
// input is a terminal.
hal::Result<std::string> joined_operands(const CLI::App& command);

// The commands' bytes; nothing if the text is wrong or empty: then this has printed an error, with
// a caret under the place.
std::optional<std::vector<std::uint8_t>> encode_or_explain(std::string_view text,
                                                           oi::Beyond beyond);

// Bytes as people write them: `89 ff`, `0x89,0xff`, `89FF`, `[89][ff]`; in decimal 0 to 255, or
// -128 to -1 for their two's complement.
enum class Base : std::uint8_t { hexadecimal, decimal };
hal::Result<std::vector<std::uint8_t>> read_bytes(std::string_view text, Base base);

// Like hal::read_input(), or reads standard input for `-`; a failure has the complete message.
hal::Result<std::string> read_all(const std::string& path, const hal::InputLimits& limits = {});

}  // namespace cargobay::cli
