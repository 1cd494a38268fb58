#include "hal/sim/remote/chosen_robot.hpp"

#include <utility>

#include "oi/dialect.hpp"

namespace cargobay::hal {

Result<ChosenRobot> choose_robot(const Config& config, const sim::Parameters& robot,
                                 int create_priority) {
  ChosenRobot chosen{.port = config.port};
  if (!chosen.port.empty()) {
    auto lines = open_pins(config.pins);
    if (!lines) return lines.failure();
    chosen.lines = std::move(*lines);
    return chosen;
  }
  auto create = sim::VirtualCreate::start(robot, config.baud.value_or(robot.dialect->default_baud),
                                          create_priority);
  if (!create) return create.failure();
  chosen.create = std::move(*create);
  chosen.port = chosen.server()->path();
  return chosen;
}

}  // namespace cargobay::hal
