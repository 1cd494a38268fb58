// What a command drives: a robot and the lines to its pins, or a virtual Create of its own.
#pragma once

#include <memory>
#include <string>

#include "hal/bring_up/bring_up.hpp"
#include "hal/bring_up/open_pins.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/config/config.hpp"
#include "hal/result.hpp"
#include "hal/sim/remote/virtual_create.hpp"

namespace cargobay::cli {

struct Plant {
  std::string port;
  std::unique_ptr<hal::sim::VirtualCreate> create{};
  hal::OpenPins lines{};

  hal::RobotPins pins() const { return create ? create->pins() : lines.pins(); }
  // Null for a robot.
  hal::sim::Server* server() const { return create ? &create->server() : nullptr; }
};

// A virtual Create if the configuration names no port; its thread gets a real-time priority above
// ordinary work and below the loop's, which is `priority`. Pins without a port are a failure.
hal::Result<Plant> find_plant(const hal::Config& config, const PinOptions& pins,
                              const SimOptions& sim, int priority);

}  // namespace cargobay::cli
