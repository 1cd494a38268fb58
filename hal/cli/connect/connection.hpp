// The options that say how a robot is wired: port, rate, pins; and the configuration file that they
// override.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/cli/terminal/outputs.hpp"
#include "hal/config/config.hpp"
#include "hal/learnt/learnt_place.hpp"
#include "hal/result.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/remote/chosen_robot.hpp"

namespace CLI {
class App;
}

namespace cargobay::cli {

struct PortOptions {
  std::string config_file;
  bool config_may_be_new = false;  // a file that is not there counts as an empty one
  std::optional<std::string> port{};
  std::optional<std::uint32_t> baud{};
};

struct LineOptions {
  std::optional<std::string> chip{};
  std::optional<std::string> line{};
};

struct PinOptions {
  LineOptions brc{};
  LineOptions power{};
  LineOptions power_sense{};
  LineOptions charging{};
  bool active_low = false;  // of the BRC line
  bool open_drain = false;  // of the BRC line
  bool power_active_low = false;

  bool any_line() const { return brc.line || power.line || power_sense.line || charging.line; }
};

// Whether a drive begins from what an earlier one learnt.
struct LearntOptions {
  std::optional<std::string> file{};  // or "none"
  bool forget = false;
};

// `options` outlives the parsing.
void add_learnt_options(CLI::App& command, LearntOptions& options);
// By options and configuration.
hal::LearntPlace learnt_place(const LearntOptions& options, const hal::Config& config);

// `options` outlives the parsing.
void add_port_options(CLI::App& command, PortOptions& options);
void add_pin_options(CLI::App& command, PinOptions& options);

// The configuration, overridden by the options. The rate is set, and is one that the robot has.
hal::Result<hal::Config> configuration(const PortOptions& port, const PinOptions& pins = {});

// Whether --config names a file that is not there.
bool is_new_config(const PortOptions& port);

// Keeps the files that configuration() reads from being written to.
void protect_config(const PortOptions& port, Outputs& outputs);

// For a command that talks to a robot as it is: the one at the port, no pin of which is touched; or
// a virtual Create that listens at the configured rate, which a remark says.
hal::Result<hal::ChosenRobot> find_plain_robot(const hal::Config& config);

// As hal::choose_robot(); options for pins without a port are a failure.
hal::Result<hal::ChosenRobot> choose_robot(const hal::Config& config, const PinOptions& pins,
                                           const hal::sim::Parameters& robot, int create_priority);

}  // namespace cargobay::cli
