// `cargobay bringup`: takes the robot from any state to one that answers at the wanted rate.

#include <cstdio>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cli/commands.hpp"
#include "hal/cli/connect/bring_up_report.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/guard/duty.hpp"
#include "hal/stream/write_all.hpp"
#include "oi/encode.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

// All that a robot that does not move can report.
constexpr oi::StreamList kPackets = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::charging_state, oi::PacketId::voltage);
constexpr std::chrono::milliseconds kLastWords{200};

struct BringupOptions {
  PortOptions port{};
  PinOptions pins{};
  std::string mode = "passive";
  bool builtin = false;
  std::string json_file;
};

// Nothing listens from here on. If Safe or Full was asked for, the robot is left in that mode.
hal::Result<void> end_stream(hal::ByteStream& stream, oi::Mode mode, hal::Duty& duty) {
  if (mode == oi::Mode::passive) {
    if (duty.discharge().standing()) return {};
    return hal::Failure{
        "the robot answered, but did not confirm that it is Passive again; look at it, and press "
        "its power button if it moves"};
  }
  const auto pause = oi::encode(oi::PauseResumeStream{oi::StreamState::pause});
  const bool told = pause && hal::write_all(stream, *pause) && stream.drain(kLastWords);
  if (told) duty.waive();
  if (told) return {};
  return hal::Failure{"the port failed at the end of the bring-up" + hal::fate(duty.discharge())};
}

int conclude(const BringupOptions& options, const BringUpRecord& record,
             const hal::Result<hal::BringUpReport>& result, const hal::Result<void>& left,
             std::optional<int> signal, Outputs& outputs) {
  if (result && options.json_file != "-") fmt::print("{}", summary(record, *result));
  hal::Result<void> done = outputs.write("--json", json(record, result));
  if (signal) return kSignalled + *signal;
  if (!left) done = left;
  if (!result) done = result.failure();
  if (done) return kSuccess;
  print_error(done.failure().message);
  return kFailure;
}

int bring_up(const BringupOptions& options) {
  StopSignals signals{SIGTSTP};  // suspended by Ctrl-Z, it would leave the pin low
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  Outputs outputs;
  protect_config(options.port, outputs);
  if (const auto done = outputs.open("--json", options.json_file); !done)
    return fail(done.failure());
  auto config = configuration(options.port, options.pins);
  if (!config) return fail(config.failure());
  if (options.builtin) config->port.clear();
  const auto chosen = choose_robot(*config, options.pins, {}, 0);
  if (!chosen) return fail(chosen.failure());
  BringUpRecord record{.port = chosen->port,
                       .robot = chosen->create ? "virtual Create" : "robot",
                       .baud = *config->baud};
  auto stream = open_for_use(record.port, record.baud);
  if (!stream) return fail(stream.failure());

  const auto mode = oi::value_named<oi::Mode>(options.mode).value_or(oi::Mode::safe);  // checked
  auto duty = hal::Duty::begin(**stream, {}, 0);
  if (!duty) return fail(duty.failure());
  std::optional<int> signal;
  hal::Parting left = hal::Parting::unconfirmed;
  const auto result = hal::bring_up(**stream, {.mode = mode,
                                               .packets = kPackets,
                                               .pins = chosen->pins(),
                                               .progress =
                                                   [&](const hal::BringUpEvent& event) {
                                                     record.steps.push_back(event);
                                                     if (options.json_file == "-") return;
                                                     fmt::print("{}", line(event));
                                                     std::fflush(stdout);
                                                   },
                                               .cancelled =
                                                   [&] {
                                                     if (!signal)
                                                       signal = signals.wait(rt::Duration::zero());
                                                     return signal.has_value();
                                                   },
                                               .left = &left});
  if (result) {
    return conclude(options, record, result, end_stream(**stream, mode, **duty), signal, outputs);
  }
  const hal::Failure failure{result.failure().message + hal::fate((*duty)->discharge_after(left)),
                             result.failure().code};
  return conclude(options, record, failure, {}, signal, outputs);
}

}  // namespace

void add_bringup(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<BringupOptions>();
  CLI::App* command = app.add_subcommand(
      "bringup",
      "Find the robot at whatever rate and state it is in, and bring it to the wanted rate and "
      "mode:\npower-on by its toggle, BRC pulses or the Baud command, freeing it from half a "
      "command.\nWithout --port, on a virtual Create of its own.");
  add_port_options(*command, options->port);
  command->add_option("--mode", options->mode, "Mode to leave it in; safe and full do not charge")
      ->check(CLI::IsMember({"passive", "safe", "full"}))
      ->capture_default_str();
  command->add_flag("--virtual", options->builtin,
                    "Use a virtual Create of its own, even if the configuration names a port");
  command->add_option("--json", options->json_file,
                      "Write steps and result to this file; - for standard output");
  add_pin_options(*command, options->pins);
  command->footer(
      "Examples:\n"
      "  cargobay bringup --baud 19200\n"
      "  cargobay bringup --port /dev/ttyAMA0 --baud 19200 --brc-chip pinctrl-bcm2835 --brc-line "
      "17 --active-low");
  command->callback([options, &chosen] { chosen = [options] { return bring_up(*options); }; });
}

}  // namespace cargobay::cli
