// Changes a few values in a configuration's text, and leaves all else as its owner wrote it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cargobay::hal {

struct ConfigValue {
  std::string key{};
  std::string value{};  // as TOML has it: 258.0, "lost"
};

// The text with these values in its table [`table`], which is added where there is none. A line
// that sets one of the keys is replaced, a comment behind it is kept; other keys are added at the
// end of the table.
std::string set_values(std::string_view text, std::string_view table,
                       const std::vector<ConfigValue>& values);

}  // namespace cargobay::hal
