// What the control socket does to the wheels: how they answer, a load, a wheel that is stuck.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hal/sim/line/cable.hpp"

namespace cargobay::hal::sim {

// As handlers of ControlInfo. "[NAME] [VALUE NUMBER]...", "PART [SIDE] [MS]", "SIDE [MS]".
std::optional<std::string> change_plant(std::string_view rest, Cable& cable);
std::optional<std::string> change_load(std::string_view rest, Cable& cable);
std::optional<std::string> change_stuck(std::string_view rest, Cable& cable);

}  // namespace cargobay::hal::sim
