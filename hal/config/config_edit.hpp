// Changes a few values in the text of a configuration, and leaves the rest as its owner wrote it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cargobay::hal {

struct ConfigValue {
  std::string key{};
  std::string value{};  // in TOML: 258.0, "lost"
};

// The text with these values in its table [`table`], which is added if it is missing. A line that
// sets one of the keys is replaced, and a comment after it kept; other keys are added at the end of
// the table.
std::string set_values(std::string_view text, std::string_view table,
                       const std::vector<ConfigValue>& values);

}  // namespace cargobay::hal
