// The options that say what kind of robot the virtual Create is.
#pragma once

#include <string>
#include <vector>

#include "hal/result.hpp"
#include "hal/sim/parameters.hpp"

namespace CLI {
class App;
}
namespace cargobay::hal::sim {
class Server;
}

namespace cargobay::cli {

struct SimOptions {
  std::string remainder = "carried";
  std::string checksum = "including";
  std::string power_on = "long-ago";
  bool extensions = false;
  bool no_charging_text = false;
  std::string plant = "default";
  std::vector<std::string> plant_values{};  // one each, as hal::sim::plant_values(); may be empty
  std::vector<std::string> later{};         // "SECONDS COMMAND" of the control socket
  hal::sim::Parameters parameters{};
};

// `options` outlives the parsing.
void add_sim_options(CLI::App& app, SimOptions& options);
// Call it after the parsing.
hal::sim::Parameters parameters(const SimOptions& options);
// What is to be done to it later. Call it once, before anything drives it.
void schedule(const SimOptions& options, hal::sim::Server& server);

}  // namespace cargobay::cli
