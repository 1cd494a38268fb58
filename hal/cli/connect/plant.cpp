#include "hal/cli/connect/plant.hpp"

#include <algorithm>
#include <utility>

namespace cargobay::cli {

hal::Result<Plant> find_plant(const hal::Config& config, const PinOptions& pins,
                              const SimOptions& sim, int priority) {
  Plant plant{.port = config.port};
  if (!plant.port.empty()) {
    auto lines = hal::open_pins(config.pins);
    if (!lines) return lines.failure();
    plant.lines = std::move(*lines);
    return plant;
  }
  if (pins.any_line()) return hal::Failure{"the pins of a robot need its --port"};
  // A wire does not wait for the CPU.
  auto started =
      hal::sim::VirtualCreate::start(parameters(sim), *config.baud, std::max(priority - 10, 0));
  if (!started) return started.failure();
  plant.create = std::move(*started);
  plant.port = plant.create->server().path();
  return plant;
}

}  // namespace cargobay::cli
