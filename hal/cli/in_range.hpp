// Checks of numbers on the command line.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

namespace cargobay::cli {

// A number from `lowest` to `highest`. CLI::Range alone lets "nan" pass, which is neither below the
// one nor above the other.
inline CLI::Validator in_range(double lowest, double highest) {
  const CLI::Range range{lowest, highest};
  CLI::Validator validator{range};
  validator.operation([range](std::string& text) {
    if (std::isnan(std::strtod(text.c_str(), nullptr))) return "'" + text + "' is not a number";
    return range(text);
  });
  return validator;
}

// A whole number of 64 bits without a sign. CLI11 takes -1 for the largest of them, and so it does
// with larger ones.
inline CLI::Validator whole_number() {
  return CLI::Validator{[](const std::string& text) {
                          std::uint64_t value = 0;
                          const char* const last = text.data() + text.size();
                          const auto [end, error] = std::from_chars(text.data(), last, value);
                          const bool whole = error == std::errc{} && end == last;
                          return whole ? std::string{}
                                       : "'" + text + "' is not a whole number from 0 to 2^64 - 1";
                        },
                        ""};
}

}  // namespace cargobay::cli
