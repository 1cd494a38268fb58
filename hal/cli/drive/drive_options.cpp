#include "hal/cli/drive/drive_options.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/drive/profile.hpp"
#include "hal/config/settings.hpp"
#include "hal/range.hpp"
#include "oi/limits.hpp"

namespace cargobay::cli {
namespace {

constexpr double kLongestWaitS = 86400.0;

int priority(const DriveOptions& options, const hal::Config& config) {
  return options.priority.value_or(config.priority.value_or(rt::RealtimeRequest{}.priority));
}

}  // namespace

hal::Result<void> check(const DriveOptions& options) {
  if (!(std::abs(options.speed_mm_s) <= oi::kMaxWheelSpeed)) {
    return hal::Failure{
        fmt::format("--speed {:g} is beyond the robot's -500 to 500 mm/s", options.speed_mm_s)};
  }
  constexpr hal::Range kSpeeds{1.0, oi::kMaxWheelSpeed};
  if (options.speed_mm_s != 0.0 && !kSpeeds.contains(std::abs(options.speed_mm_s))) {
    return hal::Failure{fmt::format(
        "--speed {:g} is less than the 1 mm/s that the robot is told{}", options.speed_mm_s,
        hal::likely_meaning({-kSpeeds.most, kSpeeds.most}, hal::kNotMmS, options.speed_mm_s))};
  }
  const bool sensible = options.duration_s > 0.0 && options.duration_s <= 86400.0;  // false for NaN
  if (!sensible) {
    return hal::Failure{fmt::format(
        "--duration {:g} is not above 0 and at most 86400 seconds{}", options.duration_s,
        hal::likely_meaning({1.0, 86400.0}, hal::kNotSeconds, options.duration_s))};
  }
  if (!hal::kGuardDeadlineMs.contains(options.guard_deadline_ms)) {
    return hal::Failure{fmt::format(
        "--guard-deadline {:g} is not within {} ms{}", options.guard_deadline_ms,
        hal::kGuardDeadlineMs.words(),
        hal::likely_meaning(hal::kGuardDeadlineMs, hal::kNotMs, options.guard_deadline_ms))};
  }
  const bool waits = reconnect_s(options) > 0.0 && reconnect_s(options) <= kLongestWaitS;
  if (!options.reconnect.empty() && !waits) {
    return hal::Failure{fmt::format("--reconnect={} is not above 0 and at most {:g} seconds",
                                    options.reconnect, kLongestWaitS)};
  }
  if (options.record_file == "-")
    return hal::Failure{"--record needs a file name: a recording is binary, not text"};
  return {};
}

hal::Result<void> open_outputs(const DriveOptions& options, Outputs& outputs) {
  if (auto good = check_picture_name("--plot", options.plot_file); !good) return good;
  protect_config(options.connection, outputs);
  if (options.learnt.file && *options.learnt.file != "none")
    outputs.protect("what was learnt", *options.learnt.file);
  if (!Profile::is_named(options.profile)) outputs.protect("the profile", options.profile);
  if (auto done = outputs.open("--record", options.record_file); !done) return done;
  if (auto done = outputs.open("--json", options.json_file); !done) return done;
  return outputs.open("--plot", options.plot_file);
}

double reconnect_s(const DriveOptions& options) {
  if (options.reconnect.empty()) return 0.0;
  const char* const end = options.reconnect.data() + options.reconnect.size();
  double seconds = 0.0;
  const auto [parsed, error] = std::from_chars(options.reconnect.data(), end, seconds);
  const bool number = error == std::errc{} && parsed == end;
  return number ? seconds : std::numeric_limits<double>::quiet_NaN();
}

void leave_cpu_to_loop(const hal::RobotOptions& robot) {
  if (robot.realtime.cpu) rt::keep_off(*robot.realtime.cpu);
}

hal::RobotOptions robot_options(const DriveOptions& options, const hal::Config& config) {
  hal::RobotOptions robot;
  hal::apply(config, robot.cycle);
  robot.cycle.loop.feedback =
      options.open_loop ? rt::WheelLoop::Feedback::open : rt::WheelLoop::Feedback::closed;
  if (options.hold_heading) robot.cycle.loop.course.hold_heading = true;
  if (options.drive_on) robot.cycle.on_implausible = hal::OnImplausible::report;
  robot.cycle.drive_mode = options.full ? oi::Mode::full : oi::Mode::safe;
  robot.realtime = {.priority = priority(options, config),
                    .cpu = options.cpu ? options.cpu : config.cpu};
  robot.require_realtime = options.require_rt || config.require_realtime;
  robot.guard.use =
      options.no_guard ? hal::GuardOptions::Use::none : hal::GuardOptions::Use::required;
  robot.guard.deadline = std::chrono::duration_cast<rt::Duration>(
      std::chrono::duration<double, std::milli>{options.guard_deadline_ms});
  return robot;
}

namespace {

void add_realtime_options(CLI::App& command, DriveOptions& options) {
  command.add_flag("--require-rt", options.require_rt,
                   "Fail if SCHED_FIFO or locked memory is refused");
  command
      .add_option("--guard-deadline", options.guard_deadline_ms,
                  "Milliseconds without a sign of life from the loop, after which the guard "
                  "process stops the robot, " +
                      hal::kGuardDeadlineMs.words())
      ->capture_default_str();
  command.add_flag("--no-guard", options.no_guard,
                   "Drive without the guard process: if this program dies the wheels keep turning");
  command
      .add_option(
          "--priority", options.priority,
          fmt::format("SCHED_FIFO priority of the loop [{}]", rt::RealtimeRequest{}.priority))
      ->check(CLI::Range(static_cast<int>(hal::kPriority.least),
                         static_cast<int>(hal::kPriority.most)));
  command.add_option("--cpu", options.cpu,
                     "Pin the loop to this CPU; the rest of the program keeps off it");
}

void add_first_options(CLI::App& command, DriveOptions& options) {
  add_port_options(command, options.connection);
  add_learnt_options(command, options.learnt);
  command.add_flag("--virtual", options.builtin,
                   "Drive a virtual Create of its own, even if the configuration names a port");
  command.add_flag(
      "--hold-heading", options.hold_heading,
      "Let the heading follow what the wheels were asked for so far, also across stops");
  command.add_flag(
      "--full", options.full,
      "Drive in Full mode: cliffs, wheel drops and the charger no longer stop the robot");
  command.add_flag("--drive-on", options.drive_on,
                   "If a wheel is stuck, or distance and angle cannot be true, only report it");
}

void add_last_options(CLI::App& command, DriveOptions& options) {
  add_realtime_options(command, options);
  add_pin_options(command, options.pins);
  add_sim_options(command, options.sim);
}

}  // namespace

void add_robot_options(CLI::App& command, DriveOptions& options) {
  add_first_options(command, options);
  add_last_options(command, options);
}

void add_drive_options(CLI::App& command, DriveOptions& options) {
  add_first_options(command, options);
  command
      .add_option("--profile", options.profile,
                  "straight, steps, square, spin, or a file of lines SECONDS LEFT_MM_S "
                  "RIGHT_MM_S, repeated until the end")
      ->capture_default_str();
  command
      .add_option("--speed", options.speed_mm_s,
                  "Wheel speed of the named profiles in mm/s, -500 to 500")
      ->capture_default_str();
  command.add_option("--duration", options.duration_s, "Seconds to drive")->capture_default_str();
  command.add_flag("--open-loop", options.open_loop,
                   "Send the set speeds as they are, to see what the loop gains");
  command.add_flag("--reconnect{30}", options.reconnect,
                   "If the port hangs up or the robot falls silent, wait this many seconds "
                   "(--reconnect=60; 30 by default), and drive on when it is back");
  command.add_option("--json", options.json_file,
                     "Write the results to this file; - for standard output");
  command.add_option(
      "--plot", options.plot_file,
      "Draw set, true, estimated and commanded speed to this file: SVG, or PNG if it "
      "ends in .png");
  command.add_option(
      "--record", options.record_file,
      "Record every byte, time and state to this file, for cargobay replay, plot and "
      "export (about 10 kB a second); as MCAP, for Foxglove, if it ends in .mcap "
      "(about 150 kB a second)");
  command.add_flag("--no-feed", options.no_feed,
                   "Do not publish what the drive knows; otherwise `cargobay sensors`, `top` and "
                   "others can watch it");
  command.add_flag("--boost-kworkers", options.boost_kworkers,
                   "Give the kernel threads that hand over the port's bytes a real-time priority "
                   "too, just below the loop's, until the drive ends (needs CAP_SYS_NICE)");
  add_last_options(command, options);
  command.footer(
      "Examples:\n"
      "  cargobay drive\n"
      "  cargobay drive --profile steps --remainder lost --plot steps.svg\n"
      "  cargobay drive --baud 19200\n"
      "  cargobay drive --port /dev/ttyUSB0 --profile square --speed 300\n"
      "  cargobay drive --port /dev/ttyUSB0 --duration 3600 --reconnect=60\n"
      "  cargobay drive --record drive.rec\n"
      "  cargobay drive --record drive.mcap");
}

}  // namespace cargobay::cli
