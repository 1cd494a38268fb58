#include "hal/cli/terminal/print.hpp"

#include <unistd.h>

#include <cstdio>

#include <fmt/core.h>

namespace cargobay::cli {

void print_error(std::string_view message) { fmt::print(stderr, "cargobay: error: {}\n", message); }
void print_remark(std::string_view message) { fmt::print(stderr, "cargobay: {}\n", message); }
bool stdout_is_terminal() { return isatty(STDOUT_FILENO) == 1; }

}  // namespace cargobay::cli
