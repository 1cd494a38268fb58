// Where the command prints its messages.
#pragma once

#include <string_view>

namespace cargobay::cli {

// Prints one line to standard error, after the program's name.
void print_error(std::string_view message);
// The same, for remarks that stop nothing.
void print_remark(std::string_view message);
bool stdout_is_terminal();

}  // namespace cargobay::cli
