#include "hal/sim/remote/plant.hpp"

#include <utility>

#include "oi/dialect.hpp"

namespace cargobay::hal {

Result<Plant> find_plant(const Config& config, const sim::Parameters& robot, int create_priority) {
  Plant plant{.port = config.port};
  if (!plant.port.empty()) {
    auto lines = open_pins(config.pins);
    if (!lines) return lines.failure();
    plant.lines = std::move(*lines);
    return plant;
  }
  auto create = sim::VirtualCreate::start(robot, config.baud.value_or(robot.dialect->default_baud),
                                          create_priority);
  if (!create) return create.failure();
  plant.create = std::move(*create);
  plant.port = plant.server()->path();
  return plant;
}

}  // namespace cargobay::hal
