// The faults that `cargobay sim --fault` names: at once, or some time after the robots are served.
#pragma once

#include <string>
#include <string_view>

#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {

struct PlannedFault {
  rt::Duration after{0};  // zero: before anybody can open the port
  std::string command;    // of hal/sim/remote/fault_command.hpp
};

// "[at SECONDS] NAME [ARGUMENTS]". A failure says what would be right.
hal::Result<PlannedFault> parse_fault(std::string_view text);

// All faults and what they take, a line each.
std::string list_faults();

}  // namespace cargobay::cli
