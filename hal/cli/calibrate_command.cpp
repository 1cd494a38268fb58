// `cargobay calibrate`: measures what kind of robot this is, and writes it to the configuration.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/bring_up_report.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/config/config_edit.hpp"
#include "hal/file/read_input.hpp"
#include "hal/range.hpp"
#include "hal/robot/calibration.hpp"
#include "hal/robot/robot.hpp"
#include "rt/realtime.hpp"

namespace cargobay::cli {
namespace {

constexpr int kPriority = 80;
constexpr std::chrono::milliseconds kPause{100};
constexpr std::chrono::seconds kWarning{3};

struct CalibrateOptions {
  PortOptions port{};
  PinOptions pins{};
  LearntOptions learnt{};
  SimOptions sim{};
  double speed_mm_s = 200.0;
  std::string write_file;
  std::string json_file;
};

// The context of the control function.
struct Pattern {
  const hal::Calibration* calibration = nullptr;
  hal::ControlCycle* cycle = nullptr;

  static hal::ControlAnswer control(void* context, const hal::CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    const auto& self = *static_cast<Pattern*>(context);
    if (seconds >= hal::Calibration::duration_s()) self.cycle->request_stop();
    return self.calibration->at(seconds);
  }
};

std::string name(rt::RemainderBelief remainder) {
  switch (remainder) {
    case rt::RemainderBelief::carried: return "carried";
    case rt::RemainderBelief::lost: return "lost";
    case rt::RemainderBelief::unknown: break;
  }
  return "unknown";
}

// Drives the pattern. Returns the signal that ended it early, if one did.
hal::Result<std::optional<int>> drive(hal::Robot& robot, hal::Calibration& calibration,
                                      StopSignals& signals) {
  Pattern pattern{.calibration = &calibration, .cycle = &robot.cycle()};
  const auto grant = robot.start({.function = &Pattern::control, .context = &pattern});
  if (!grant) return grant.failure();
  const AtFirstSignal stop{[&robot] { robot.cycle().request_stop(); }};  // whatever this waits for
  std::optional<int> signal;
  hal::CycleState state;
  while (!robot.ended() && !signal) {
    signal = signals.wait(kPause);
    while (robot.cycle().next_state(state)) calibration.see(state);
    show_line(fmt::format("{:5.1f} / {:g} s   speed {:6.1f} {:6.1f} mm/s",
                          static_cast<double>(state.tick) * 0.015, hal::Calibration::duration_s(),
                          state.estimate.left_mm_s, state.estimate.right_mm_s));
  }
  clear_line();
  const hal::Robot::Farewell farewell = robot.stop();
  while (robot.cycle().next_state(state)) calibration.see(state);
  if (!signal) signal = signals.wait(rt::Duration::zero());
  if (const std::string wrong = hal::explain(farewell); !wrong.empty()) return hal::Failure{wrong};
  return signal;
}

std::string table(const hal::CalibrationResult& result) {
  return fmt::format(
      "Wheel base   {:.1f} mm   (four turns within {:.1f} mm)\n"
      "Lag          {:.0f} ms   (the loop learns it by itself, at each drive)\n"
      "Gain         {:.3f} left, {:.3f} right   (the same)\n"
      "Remainder    {}   (the same)\n",
      result.wheel_base_mm, result.wheel_base_spread_mm, 1e3 * result.lag_s, result.gain_left,
      result.gain_right, name(result.remainder));
}

std::string result_json(const hal::CalibrationResult& result) {
  const nlohmann::ordered_json text{
      {"wheel_base_mm", result.wheel_base_mm},
      {"wheel_base_spread_mm", result.wheel_base_spread_mm},
      {"lag_s", result.lag_s},
      {"gain", {{"left", result.gain_left}, {"right", result.gain_right}}},
      {"remainder", name(result.remainder)}};
  return text.dump(2) + "\n";
}

// Empty if there is no such file yet.
hal::Result<std::string> contents(const std::string& file) {
  auto text = hal::read_input(file, {.most_bytes = hal::kMostConfigBytes});
  if (text || text.failure().code == std::errc::no_such_file_or_directory)
    return text ? *text : std::string{};
  return hal::Failure{
      fmt::format("cannot read the configuration {}: {}", file, text.failure().message)};
}

// Writes to the file what motion alone does not tell; the rest is learnt by each drive, and would
// only be in its way. Leaves the file untouched if anything is wrong with it.
hal::Result<void> write_config(const std::string& file, const hal::CalibrationResult& result,
                               Outputs& outputs) {
  const std::vector<hal::ConfigValue> values{
      {.key = "wheel_base_mm", .value = fmt::format("{:.1f}", result.wheel_base_mm)}};
  const auto before = contents(file);
  if (!before) return before.failure();
  const std::string text = hal::set_values(*before, "robot", values);
  hal::Config config;
  if (auto valid = hal::read_config(text, file, config); !valid) return valid;
  return outputs.write("--write", text);
}

// Opens the files. An existing configuration must be a valid one.
hal::Result<void> check(const CalibrateOptions& options, Outputs& outputs) {
  if (!(options.speed_mm_s >= 100.0 && options.speed_mm_s <= 400.0)) {
    return hal::Failure{
        fmt::format("--speed {:g} is not between 100 and 400 mm/s{}", options.speed_mm_s,
                    hal::likely_meaning({100.0, 400.0}, hal::kNotMmS, options.speed_mm_s))};
  }
  if (options.write_file == "-")
    return hal::Failure{"--write needs the name of a file, such as /etc/cargobay.toml"};
  protect_config(options.port, outputs);
  if (options.learnt.file && *options.learnt.file != "none")
    outputs.protect("what was learnt", *options.learnt.file);
  if (auto done = outputs.open_to_edit("--write", options.write_file); !done) return done;
  if (auto done = outputs.open("--json", options.json_file); !done) return done;
  if (options.write_file.empty()) return {};
  const auto text = contents(options.write_file);
  if (!text) return text.failure();
  hal::Config config;
  return hal::read_config(*text, options.write_file, config);
}

// Writes the result to every place where it is wanted.
hal::Result<void> report(const CalibrateOptions& options, const hal::CalibrationResult& result,
                         Outputs& outputs) {
  const bool prints = options.json_file != "-";
  if (prints) fmt::print("{}", table(result));
  if (auto done = outputs.write("--json", result_json(result)); !done) return done;
  if (options.write_file.empty()) return {};
  if (auto done = write_config(options.write_file, result, outputs); !done) return done;
  if (prints) fmt::print("Written to   {}\n", options.write_file);
  return {};
}

// The robot is about to move: gives its owner a moment. Returns the signal that came meanwhile.
std::optional<int> warn(const CalibrateOptions& options, StopSignals& signals) {
  print_remark(
      fmt::format("the robot will drive about {:.0f} mm forward and back, then turn about each "
                  "wheel, for {:.0f} s; keep the floor clear (Ctrl-C stops it)",
                  2.0 * options.speed_mm_s, hal::Calibration::duration_s()));
  return signals.wait(kWarning);
}

// Brings the robot up, drives and measures. Nothing if a signal ended it; `signal` is then set.
hal::Result<std::optional<hal::CalibrationResult>> measure(const CalibrateOptions& options,
                                                           const hal::Config& config,
                                                           const hal::ChosenRobot& chosen,
                                                           StopSignals& signals,
                                                           std::optional<int>& signal) {
  auto stream = open_for_use(chosen.port, *config.baud);
  if (!stream) return stream.failure();
  hal::RobotOptions wanted;
  hal::apply(config, wanted.cycle);
  hal::Calibration::prepare(wanted.cycle);
  wanted.realtime = {.priority = config.priority.value_or(kPriority), .cpu = config.cpu};
  wanted.pins = chosen.pins();
  wanted.learnt = learnt_place(options.learnt, config);
  wanted.cancelled = [&] {
    if (!signal) signal = signals.wait(rt::Duration::zero());
    return signal.has_value();
  };
  std::optional<Progress> progress{std::in_place, "bring-up"};
  wanted.progress = [&](const hal::BringUpEvent& event) { progress->say(in_words(event)); };
  auto robot = hal::Robot::open(std::move(*stream), wanted);
  progress.reset();
  if (signal) return std::optional<hal::CalibrationResult>{};
  if (!robot) return robot.failure();
  hal::Calibration calibration{options.speed_mm_s};
  const auto driven = drive(**robot, calibration, signals);
  if (!driven) return driven.failure();
  signal = *driven;
  if (signal) return std::optional<hal::CalibrationResult>{};
  if (const std::string& remark = (*robot)->learnt_remark(); !remark.empty()) print_remark(remark);
  auto result = calibration.result((*robot)->delay_s(), (*robot)->began_from());
  if (!result) return result.failure();
  return std::optional{*result};
}

// With a --config that is not there yet, that is the file to write.
CalibrateOptions with_new_config(CalibrateOptions options) {
  if (!is_new_config(options.port)) return options;
  if (options.write_file.empty()) options.write_file = options.port.config_file;
  if (options.write_file != options.port.config_file) return options;
  options.port.config_may_be_new = true;
  return options;
}

int calibrate(const CalibrateOptions& given) {
  const CalibrateOptions options = with_new_config(given);
  StopSignals signals{SIGTSTP};  // suspended by Ctrl-Z, it would leave the robot rolling
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  Outputs outputs;
  if (const auto done = check(options, outputs); !done) return fail(done.failure());
  if (options.port.config_may_be_new)
    print_remark(options.write_file + " is not there yet: it will be made, with the wheel base");
  const auto config = configuration(options.port, options.pins);
  if (!config) return fail(config.failure());
  if (config->cpu) rt::keep_off(*config->cpu);
  const auto chosen = choose_robot(*config, options.pins, parameters(options.sim),
                                   hal::below_loop(config->priority.value_or(kPriority)));
  if (!chosen) return fail(chosen.failure());
  std::optional<int> signal;
  if (chosen->server() == nullptr) {
    signal = warn(options, signals);
  } else {
    schedule(options.sim, *chosen->server());
  }
  if (signal) return kSignalled + *signal;
  const auto measured = measure(options, *config, *chosen, signals, signal);
  if (!measured) return fail(measured.failure());
  if (signal) return kSignalled + *signal;
  if (const auto done = report(options, **measured, outputs); !done) return fail(done.failure());
  return kSuccess;
}

}  // namespace

void add_calibrate(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Measure the wheel base, which no drive tells by itself, by driving a known pattern: forward "
      "and\nback, then turns about each wheel. It needs half a metre of clear floor around the "
      "robot, and less\nthan a minute. Lag and gain of the wheels and the kind of remainder are "
      "shown too.\nWithout --port, on a virtual Create of its own.");
  add_port_options(*command, options->port);
  CLI::Option* const config = command->get_option("--config");
  config->description(config->get_description() +
                      "; a file that is not there yet is made, as by --write");
  command->add_option("--speed", options->speed_mm_s, "Speed of the wheels in mm/s, 100 to 400")
      ->capture_default_str();
  command->add_option(
      "--write", options->write_file,
      "Write the wheel base to this configuration file; the rest of it is left as it is");
  command->add_option("--json", options->json_file,
                      "Write the result to this file; - for standard output");
  add_learnt_options(*command, options->learnt);
  add_pin_options(*command, options->pins);
  add_sim_options(*command, options->sim);
  command->footer(
      "Examples:\n"
      "  cargobay calibrate --wheel-base 262 --remainder lost\n"
      "  cargobay calibrate --port /dev/ttyUSB0\n"
      "  sudo cargobay calibrate --port /dev/ttyUSB0 --write /etc/cargobay.toml");
  command->callback([options, &chosen] { chosen = [options] { return calibrate(*options); }; });
}

}  // namespace cargobay::cli
