#include "hal/cli/terminal/in_range.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

namespace cargobay::cli {

CLI::Validator in_range(double lowest, double highest) {
  const CLI::Range range{lowest, highest};
  CLI::Validator validator{range};
  validator.operation([range](std::string& text) {
    if (std::isnan(std::strtod(text.c_str(), nullptr))) return "'" + text + "' is not a number";
    return range(text);
  });
  return validator;
}

CLI::Validator whole_number() {
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
