// What is probably wrong with a line that is not TOML.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cargobay::hal {

// For the line with this number, from 1, of a configuration that cannot be parsed: "; text goes in
// quotes: port = \"/dev/ttyUSB0\"". Empty if nothing about it is known. Pure.
std::string line_hint(std::string_view text, std::size_t line);

}  // namespace cargobay::hal
