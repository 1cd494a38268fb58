// `cargobay sensors`: the robot's sensor values, named and with units.

#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/bring_up/sensor_stream.hpp"
#include "hal/cli/commands.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/packet_list.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/sensor_format.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/guard/duty.hpp"

namespace cargobay::cli {
namespace {

constexpr int kSensorsPriority = 0;  // none

struct SensorsOptions {
  PortOptions connection{};
  std::string packets = "6";
  bool as_json = false;
  bool once = false;
};

constexpr rt::Duration kRefresh = std::chrono::milliseconds{200};

void show(const SensorsOptions& options, const std::vector<oi::PacketId>& packets,
          const oi::SensorValues& values) {
  if (options.as_json) {
    fmt::print("{}\n", json_line(packets, values));
  } else {
    fmt::print("{}", lines(packets, values));
  }
  std::fflush(stdout);
}

// Prints frames as they come, until a signal. Redraws the table at a rate that eyes can follow.
int watch(const SensorsOptions& options, const std::vector<oi::PacketId>& packets,
          hal::SensorStream& stream, StopSignals& signals) {
  rt::TimePoint next_draw{};
  while (!signals.wait(rt::Duration::zero()).has_value() && !output_error()) {
    const auto values = stream.next();
    if (!values) {
      print_error(values.failure().message);
      return kFailure;
    }
    if (!options.as_json) {
      const rt::TimePoint now = rt::Clock::now();
      if (now < next_draw) continue;
      next_draw = now + kRefresh;
      fmt::print("\033[H\033[J");
    }
    show(options, packets, *values);
    if (options.once) break;
  }
  return kSuccess;
}

int sensors(const SensorsOptions& options) {
  StopSignals signals;
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  const auto packets = read_packet_list(options.packets);
  if (!packets) return fail(packets.failure());
  const auto config = configuration(options.connection);
  if (!config) return fail(config.failure());
  if (!has_port(*config)) return kUsageError;
  auto port = open_for_use(config->port, *config->baud);
  if (!port) return fail(port.failure());
  // If this program is killed, the stream is still stopped and the port restored.
  auto duty = hal::Duty::begin(**port, {}, kSensorsPriority);
  if (!duty) return fail(duty.failure());
  // A live table needs a terminal; elsewhere one reading makes more sense.
  if (options.once || (!options.as_json && !stdout_is_terminal())) {
    const auto values = hal::query_sensors(**port, *packets);
    (*duty)->waive();
    if (!values) return fail(values.failure());
    show(options, *packets, *values);
    return kSuccess;
  }
  auto stream = hal::SensorStream::open(**port, *packets);
  const int code = stream ? watch(options, *packets, **stream, signals) : fail(stream.failure());
  if (stream) stream->reset();  // pauses the stream
  (*duty)->waive();             // nothing was told to move
  return code;
}

}  // namespace

void add_sensors(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<SensorsOptions>();
  CLI::App* command = app.add_subcommand(
      "sensors",
      "Show the robot's sensors, named and with units: a live table on a terminal, otherwise one "
      "reading.\n"
      "A robot that is off is started, and stays in Passive; one that runs keeps its mode.");
  add_port_options(*command, options->connection);
  command
      ->add_option("--packets", options->packets,
                   "Packets by number or name, separated by commas; 6 is all")
      ->capture_default_str();
  command->add_flag("--json", options->as_json, "One JSON object per frame, every 15 ms");
  command->add_flag("--once", options->once, "Take one reading, then exit");
  command->footer(
      "Examples:\n"
      "  cargobay sensors --port /dev/ttyUSB0\n"
      "  cargobay sensors --port /tmp/create --packets distance,angle,oi_mode --json");
  command->callback([options, &chosen] { chosen = [options] { return sensors(*options); }; });
}

}  // namespace cargobay::cli
