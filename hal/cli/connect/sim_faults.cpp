#include "hal/cli/connect/sim_faults.hpp"

#include <fmt/core.h>

#include "hal/sim/next_word.hpp"
#include "hal/sim/remote/fault_command.hpp"

namespace cargobay::cli {
namespace {

constexpr double kLatestS = 1e6;

}  // namespace

hal::Result<PlannedFault> parse_fault(std::string_view text) {
  PlannedFault fault;
  std::string_view rest = text;
  if (std::string_view words = text; hal::sim::next_word(words) == "at") {
    const std::optional<double> after_s =
        hal::sim::to_number(hal::sim::next_word(words), 0.0, kLatestS);
    if (!after_s) return hal::Failure{.message = "the usage is 'at SECONDS NAME [ARGUMENTS]'"};
    fault.after = rt::Duration{static_cast<std::int64_t>(*after_s * 1e9)};
    rest = words;
  }
  fault.command = rest;
  // Tried on a separate robot: only the robot knows which arguments make sense.
  hal::sim::Device device{{}};
  hal::sim::Cable cable{device};
  const std::string problem = hal::sim::apply_fault(fault.command, cable);
  if (!problem.empty()) return hal::Failure{.message = problem};
  return fault;
}

std::string list_faults() {
  std::string list;
  for (const hal::sim::FaultInfo& fault : hal::sim::faults()) {
    const std::string usage = fmt::format("{} {}", fault.name, fault.arguments);
    list += fmt::format("  {:<26}  {}\n", usage, fault.meaning);
  }
  return list;
}

}  // namespace cargobay::cli
