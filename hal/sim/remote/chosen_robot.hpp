// What a program drives: the robot at a port and the lines to its pins, or a virtual Create of its
// own. The one way to either, for the command, its benchmark and the C API.
#pragma once

#include <memory>
#include <string>

#include "hal/bring_up/bring_up.hpp"
#include "hal/bring_up/open_pins.hpp"
#include "hal/config/config.hpp"
#include "hal/result.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/remote/virtual_create.hpp"

namespace cargobay::hal {

struct ChosenRobot {
  std::string port{};  // to be opened at the configuration's rate
  std::unique_ptr<sim::VirtualCreate> create{};
  OpenPins lines{};

  // Valid as long as this object.
  RobotPins pins() const { return create ? create->pins() : lines.pins(); }
  // Null for a robot.
  sim::Server* server() const { return create ? &create->server() : nullptr; }
};

// The priority of a virtual Create's thread: above ordinary work and below the loop's, since a wire
// does not wait for the CPU; 0 for none.
constexpr int below_loop(int loop_priority) { return loop_priority > 10 ? loop_priority - 10 : 0; }

// A virtual Create like `robot` if the configuration names no port. Blocks for some ms; allocates;
// after a failure no line is held and nothing runs.
Result<ChosenRobot> choose_robot(const Config& config, const sim::Parameters& robot,
                                 int create_priority);

}  // namespace cargobay::hal
