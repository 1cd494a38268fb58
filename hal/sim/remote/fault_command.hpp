// The named faults, as text: what the control socket and the command line accept.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "hal/sim/line/cable.hpp"

namespace cargobay::hal::sim {

struct FaultInfo {
  std::string_view name;
  std::string_view arguments;
  std::string_view meaning;
  // Makes it happen; false if the arguments are wrong, and nothing has happened.
  bool (*apply)(std::string_view arguments, Cable& cable);
};

// All faults, one row each. P is a probability per byte, 0 to 1; the direction is to-host (the
// default), to-robot or both.
std::span<const FaultInfo> faults();

// Applies "NAME [ARGUMENTS]". Returns "" or, on error, what is wrong and what is valid.
std::string apply_fault(std::string_view command, Cable& cable);

}  // namespace cargobay::hal::sim
