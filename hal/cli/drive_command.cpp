// `cargobay drive`: the main job. Brings the robot up, closes the velocity loop for a while, and
// reports.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/drive_log.hpp"
#include "hal/cli/drive_options.hpp"
#include "hal/cli/drive_report.hpp"
#include "hal/cli/exit_codes.hpp"
#include "hal/cli/open_for_use.hpp"
#include "hal/cli/print.hpp"
#include "hal/cli/profile.hpp"
#include "hal/cli/signals.hpp"
#include "hal/cli/velocity_plot.hpp"
#include "hal/cli/virtual_create.hpp"
#include "hal/cli/write_file.hpp"
#include "hal/open_pins.hpp"
#include "hal/robot.hpp"
#include "hal/sim/server.hpp"

namespace cargobay::cli {
namespace {

constexpr double kRefresh = 0.1;  // seconds between two status lines

// The control function: follows the profile, and asks the cycle to end when its time is over.
struct Driver {
  const Profile* profile;
  double duration_s;
  hal::ControlCycle* cycle;

  static rt::WheelSpeeds control(void* context, const hal::CycleState& /*state*/,
                                 double seconds) noexcept CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Driver*>(context);
    if (seconds >= self.duration_s) self.cycle->request_stop();
    return self.profile->at(std::min(seconds, self.duration_s - 1e-6));  // not yet the next round
  }
};

void print_status(const hal::CycleState& state, double duration_s) {
  fmt::print(
      "\r{:6.1f} / {:g} s   set {:4.0f} {:4.0f}   speed {:6.1f} {:6.1f}   command {:4.0f} {:4.0f} "
      "mm/s   {:<8}",
      static_cast<double>(state.tick) * 0.015, duration_s, state.set.left_mm_s,
      state.set.right_mm_s, state.estimate.left_mm_s, state.estimate.right_mm_s,
      state.command.left_mm_s, state.command.right_mm_s, oi::name(state.mode));
  std::fflush(stdout);
}

// Collects what the loop and the virtual Create tell, until the drive ends.
class DriveFollower {
 public:
  DriveFollower(hal::ControlCycle* cycle, hal::sim::Server* server)
      : cycle_{cycle}, server_{server} {}

  void collect() {
    hal::CycleState state;
    while (cycle_->next_state(state)) states_.push_back(state);
    if (server_ != nullptr) server_->take_truth(truth_);
  }
  const std::vector<hal::CycleState>& states() const { return states_; }
  std::vector<DriveSample> samples() const { return join(states_, truth_); }

 private:
  hal::ControlCycle* cycle_;  // both outlive the follower
  hal::sim::Server* server_;
  std::vector<hal::CycleState> states_;
  std::vector<hal::sim::TruthSample> truth_;
};

// Returns the signal that ended the drive before its time.
std::optional<int> follow(hal::Robot& robot, DriveFollower& follower, StopSignals& signals,
                          double duration_s) {
  const bool live = stdout_is_terminal();
  std::optional<int> signal;
  while (!robot.ended() && !robot.guard_lost() && !signal.has_value()) {
    signal = signals.wait(
        std::chrono::duration_cast<rt::Duration>(std::chrono::duration<double>{kRefresh}));
    follower.collect();
    if (live && !follower.states().empty()) print_status(follower.states().back(), duration_s);
  }
  if (live) fmt::print("\r\033[K");
  return signal;
}

std::string plot_title(const DriveReport& report, const DriveOptions& options) {
  return fmt::format(
      "{} at {:g} mm/s, {} loop, remainder {}: steady error {:.1f} / {:.1f} mm/s, tracking rms "
      "{:.1f} / {:.1f} mm/s (left / right)",
      options.profile, options.speed_mm_s, options.open_loop ? "open" : "closed",
      name(report.remainder), report.figures.left.steady_error_mm_s,
      report.figures.right.steady_error_mm_s, report.figures.left.tracking_rmse_mm_s,
      report.figures.right.tracking_rmse_mm_s);
}

// Files, as far as they can be written.
std::optional<hal::Failure> save(const DriveReport& report, const DriveOptions& options,
                                 const std::vector<DriveSample>& samples) {
  if (!options.json_file.empty()) {
    if (auto failure = write_file(options.json_file, json(report))) return failure;
  }
  if (!options.plot_file.empty()) {
    return write_file(options.plot_file, velocity_plot(samples, plot_title(report, options)));
  }
  return std::nullopt;
}

// What went wrong, the worst first; empty where nothing did.
std::string complaint(const hal::Robot::Farewell& farewell,
                      const std::optional<hal::Failure>& unsaved) {
  if (farewell.end != hal::CycleEnd::asked) return hal::explain(farewell.end);
  if (farewell.guard_lost) {
    return "the guard process died, so the robot was stopped; find out who killed it (dmesg tells "
           "of "
           "memory running out), then start again";
  }
  if (!farewell.confirmed_passive) {
    return "the robot was told to stop and go Passive, but did not confirm; look at it, and press "
           "its power button if it moves";
  }
  return unsaved.has_value() ? unsaved->message : "";
}

// Files, table, and the last word. Returns the exit code.
int conclude(const DriveReport& report, const DriveOptions& options,
             const std::vector<DriveSample>& samples, const hal::Robot::Farewell& farewell,
             std::optional<int> signal) {
  const std::optional<hal::Failure> unsaved = save(report, options, samples);
  if (options.json_file != "-") fmt::print("{}", table(report));
  const std::string wrong = complaint(farewell, unsaved);
  if (!wrong.empty()) {
    print_error(wrong);
    return kFailure;
  }
  return signal.has_value() ? kSignalled + *signal : kSuccess;
}

// What is driven: a robot and the lines to its pins, or a virtual Create.
struct Plant {
  std::string port;
  std::unique_ptr<VirtualCreate> create{};
  hal::OpenPins lines{};

  hal::RobotPins pins() const { return create ? create->pins() : lines.pins(); }
};

hal::Result<Plant> find_plant(const DriveOptions& options, const hal::Config& config,
                              int priority) {
  Plant plant{.port = config.port};
  if (!options.builtin && !plant.port.empty()) {
    auto lines = hal::open_pins(config.pins);
    if (!lines) return lines.failure();
    plant.lines = std::move(*lines);
    return plant;
  }
  if (options.pins.any_line()) return hal::Failure{"the pins of a robot need its --port"};
  // Above ordinary work, below the loop: a wire does not wait for the CPU.
  auto started = VirtualCreate::start(parameters(options.sim), *config.baud, priority - 10);
  if (!started) return started.failure();
  plant.create = std::move(*started);
  plant.port = plant.create->server().path();
  return plant;
}

int drive(const DriveOptions& options) {
  StopSignals signals{SIGTSTP};  // suspended by Ctrl-Z it would leave the robot rolling
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (const auto failure = check(options)) return fail(*failure);
  const auto profile = Profile::load(options.profile, options.speed_mm_s);
  if (!profile) return fail(profile.failure());

  const auto config = configuration(options.connection, options.pins);
  if (!config) return fail(config.failure());
  hal::RobotOptions wanted = robot_options(options, *config);
  auto plant = find_plant(options, *config, wanted.realtime.priority);  // outlives the robot
  if (!plant) return fail(plant.failure());
  wanted.pins = plant->pins();
  hal::sim::Server* server = plant->create ? &plant->create->server() : nullptr;
  auto stream = open_for_use(plant->port, *config->baud);
  if (!stream) return fail(stream.failure());
  if (server != nullptr && options.json_file != "-")
    fmt::print("Driving a virtual Create on {}\n", plant->port);

  std::optional<int> early_signal;
  wanted.cancelled = [&] {
    if (!early_signal) early_signal = signals.wait(rt::Duration::zero());
    return early_signal.has_value();
  };
  auto opened = hal::Robot::open(std::move(*stream), wanted);
  if (early_signal) return kSignalled + *early_signal;  // it stands, or was told to
  if (!opened) return fail(opened.failure());
  hal::Robot& robot = **opened;
  Driver driver{&*profile, options.duration_s, &robot.cycle()};
  const auto grant = robot.start({.function = &Driver::control, .context = &driver});
  if (!grant) return fail(grant.failure());

  DriveFollower follower{&robot.cycle(), server};
  const std::optional<int> signal = follow(robot, follower, signals, options.duration_s);
  const hal::Robot::Farewell farewell = robot.stop();
  follower.collect();

  const std::vector<DriveSample> samples = follower.samples();
  const hal::CycleState last =
      follower.states().empty() ? hal::CycleState{} : follower.states().back();
  const DriveReport report{.port = plant->port,
                           .robot = server != nullptr ? "virtual Create" : "robot",
                           .baud = *config->baud,
                           .open_loop = options.open_loop,
                           .remainder = last.remainder,
                           .grant = *grant,
                           .ticks = last.tick,
                           .frames = robot.cycle().frames(),
                           .figures = figures(samples),
                           .period_ns = &robot.cycle().period_ns(),
                           .frame_to_command_ns = &robot.cycle().frame_to_command_ns()};
  return conclude(report, options, samples, farewell, signal);
}

}  // namespace

void add_drive(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DriveOptions>();
  CLI::App* command = app.add_subcommand(
      "drive",
      "Close the wheel-velocity loop on a robot and report how well it held.\n"
      "Without --port, drives a virtual Create of its own over a pseudo-terminal.");
  add_drive_options(*command, *options);
  command->callback([options, &chosen] { chosen = [options] { return drive(*options); }; });
}

}  // namespace cargobay::cli
