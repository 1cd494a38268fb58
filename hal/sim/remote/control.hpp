// The virtual Create by remote control, as text: it presses its buttons and puts things in front of
// its sensors. One line is one command, and the answer is one line: `ok`, `error: ...` or JSON.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/sim/line/cable.hpp"

namespace cargobay::hal::sim {

struct ControlInfo {
  std::string_view name;
  std::string_view arguments;
  std::string_view meaning;
  // Does it. The answer, empty for `ok`; nothing if the arguments are wrong, and nothing was done.
  std::optional<std::string> (*apply)(std::string_view arguments, Cable& cable);
};

// All of them, one row each.
std::span<const ControlInfo> controls();

// The answer to the line, without the newline.
std::string control(std::string_view line, Cable& cable);

// Everything about the device and its line, as one JSON object on one line.
std::string state_json(const Cable& cable);

}  // namespace cargobay::hal::sim
