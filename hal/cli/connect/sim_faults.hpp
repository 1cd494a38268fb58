// The faults that `cargobay sim --fault` names: at once, or some time after serving has begun.
#pragma once

#include <string>
#include <string_view>

#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {

struct PlannedFault {
  rt::Duration after{0};  // zero: before any client can open the port
  std::string command;    // as in hal/sim/remote/fault_command.hpp
};

// "[at SECONDS] NAME [ARGUMENTS]". A failure says what is valid.
hal::Result<PlannedFault> parse_fault(std::string_view text);

// All faults and their arguments, one per line.
std::string list_faults();

}  // namespace cargobay::cli
