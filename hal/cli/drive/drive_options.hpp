// The options of `cargobay drive`: whether they make sense, and what they mean for the robot.
#pragma once

#include <optional>
#include <string>

#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/config/config.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"

namespace CLI {
class App;
}

namespace cargobay::cli {

struct DriveOptions {
  PortOptions connection{};
  PinOptions pins{};
  LearntOptions learnt{};
  bool builtin = false;
  std::string profile = "straight";
  double speed_mm_s = 200.0;
  double duration_s = 10.0;
  bool open_loop = false;
  bool hold_heading = false;
  bool drive_on = false;  // whatever the counters say
  bool full = false;
  bool require_rt = false;
  bool no_guard = false;
  double guard_deadline_ms = 150.0;
  bool boost_kworkers = false;
  bool no_feed = false;
  std::optional<int> priority{};
  std::optional<int> cpu{};
  std::string reconnect;  // seconds to wait for a lost port; empty: not at all
  std::string json_file;
  std::string plot_file;
  std::string record_file;
  SimOptions sim{};
};

// Those that say how a robot is wired and driven, for a command that drives it in another way.
// `options` outlives the parsing.
void add_robot_options(CLI::App& command, DriveOptions& options);
// All of them.
void add_drive_options(CLI::App& command, DriveOptions& options);

// Looks for invalid values before anything moves.
hal::Result<void> check(const DriveOptions& options);

// Opens the files that the options name.
hal::Result<void> open_outputs(const DriveOptions& options, Outputs& outputs);

// --reconnect as a number: NaN if it is not one, 0 if it was not given.
double reconnect_s(const DriveOptions& options);

// The robot as options and configuration want it, but without its pins.
hal::RobotOptions robot_options(const DriveOptions& options, const hal::Config& config);

// The calling thread, and threads and processes that it starts later, keep off the CPU to which the
// loop is pinned, if it is.
void leave_cpu_to_loop(const hal::RobotOptions& robot);

}  // namespace cargobay::cli
