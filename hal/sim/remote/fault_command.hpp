// The named faults, as text: what the control socket and the command line take.
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

// All of them, one row each. P is a probability for each byte, 0 to 1; the direction is to-host
// (the default), to-robot or both.
std::span<const FaultInfo> faults();

// Applies "NAME [ARGUMENTS]". Empty, or what is wrong with it and what would be right.
std::string apply_fault(std::string_view command, Cable& cable);

}  // namespace cargobay::hal::sim
