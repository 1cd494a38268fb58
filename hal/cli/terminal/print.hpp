// Where the command's words go.
#pragma once

#include <string_view>

namespace cargobay::cli {

// One line to standard error, behind the program's name.
void print_error(std::string_view message);
// The same, for what is worth knowing but stops nothing.
void print_remark(std::string_view message);
bool stdout_is_terminal();

}  // namespace cargobay::cli
