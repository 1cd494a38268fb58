// The command line of cargobay-web.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "hal/web/address.hpp"

namespace cargobay::web {

struct Options {
  std::string feed{};
  ListenAddress address{};
  std::string token{};  // of the command line, a file or the environment; empty: none was given
  std::string token_file{};
  std::string certificate{};
  std::vector<std::string> names{};
  std::vector<std::string> origins{};
  int ready = -1;        // a descriptor, or -1 for standard output
  bool is_over = false;  // help or the version was printed
};

// `arguments`: with the program's name. Reads $CARGOBAY_TOKEN and the token's file. A failure says
// what is wrong; help and the version are printed.
hal::Result<Options> parse_options(std::span<char* const> arguments);

}  // namespace cargobay::web
