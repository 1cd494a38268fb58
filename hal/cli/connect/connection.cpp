#include "hal/cli/connect/connection.hpp"

#include <filesystem>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/terminal/print.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

constexpr const char* kPinGroup = "Pins";

void add_line(CLI::App& command, const std::string& name, LineOptions& line,
              const std::string& what) {
  CLI::Option* number = command.add_option("--" + name + "-line", line.line, what);
  number->group(kPinGroup);
  // A chip without a line means that the line was forgotten.
  command.add_option("--" + name + "-chip", line.chip, "GPIO chip of that line, by label or name")
      ->group(kPinGroup)
      ->needs(number);
}

void lay_over(const LineOptions& options, hal::PinSetting& pin) {
  if (options.chip) pin.address.chip = *options.chip;
  if (options.line) pin.address.line = *options.line;
}

void lay_over(const PinOptions& options, hal::PinSettings& pins) {
  lay_over(options.brc, pins.brc);
  lay_over(options.power, pins.power_toggle);
  lay_over(options.power_sense, pins.power_sense);
  lay_over(options.charging, pins.charging);
  if (options.active_low) pins.brc.polarity = gpio::Polarity::inverted;
  if (options.open_drain) pins.brc.drive = gpio::Drive::open_drain;
  if (options.power_active_low) pins.power_toggle.polarity = gpio::Polarity::inverted;
}

}  // namespace

void add_port_options(CLI::App& command, PortOptions& options) {
  command.add_option("--port", options.port,
                     "Serial port of the robot, or the pseudo-terminal of `cargobay sim`");
  command.add_option("--baud", options.baud,
                     "Baud rate to talk at [57600, or what the configuration says]");
  command.add_option("--config", options.config_file,
                     "Configuration file instead of /etc/cargobay.toml and "
                     "$XDG_CONFIG_HOME/cargobay.toml; options override it");
}

void add_learnt_options(CLI::App& command, LearntOptions& options) {
  command.add_option("--learnt", options.file,
                     "File that keeps what is learnt of the wheels, for the next drive to begin "
                     "from, or none [one for each serial port, see FILES; none for a virtual "
                     "Create]");
  command.add_flag("--forget", options.forget,
                   "Begin from nothing: the robot has other wheels or motors now");
}

hal::LearntPlace learnt_place(const LearntOptions& options, const hal::Config& config) {
  hal::LearntPlace place = hal::learnt_place(options.file.value_or(config.learnt), config.port);
  place.forget = options.forget;
  return place;
}

void add_pin_options(CLI::App& command, PinOptions& options) {
  add_line(
      command, "brc", options.brc,
      "To the Baud Rate Change pin: line by offset or name; or rts or dtr, of the port itself");
  add_line(
      command, "power", options.power,
      "To the power control toggle: line by offset or name; or rts or dtr, of the port itself");
  add_line(command, "power-sense", options.power_sense,
           "From the switched 5 V, high while on: line by offset or name");
  add_line(command, "charging", options.charging, "From the charging pin: line by offset or name");
  command
      .add_flag("--active-low", options.active_low,
                "The BRC line goes through an inverter, such as a transistor to ground")
      ->group(kPinGroup);
  command.add_flag("--open-drain", options.open_drain, "The BRC line only ever pulls low")
      ->group(kPinGroup);
  command
      .add_flag("--power-active-low", options.power_active_low,
                "The line of the power toggle goes through an inverter")
      ->group(kPinGroup);
}

hal::Result<hal::Config> configuration(const PortOptions& port, const PinOptions& pins) {
  const bool is_new = port.config_may_be_new && is_new_config(port);
  auto config = is_new ? hal::Config{} : hal::load_config(port.config_file);
  if (!config) return config;
  if (port.port) config->port = *port.port;
  config->baud = port.baud ? *port.baud : config->baud.value_or(oi::kCreate.default_baud);
  lay_over(pins, config->pins);
  if (!oi::kCreate.baud_code(*config->baud)) {
    return hal::Failure{
        fmt::format("the robot does not support {} baud; choose 57600 or another of {}",
                    *config->baud, fmt::join(oi::kCreate.baud_rates, ", "))};
  }
  return config;
}

bool is_new_config(const PortOptions& port) {
  std::error_code error;
  return !port.config_file.empty() && !std::filesystem::exists(port.config_file, error) && !error;
}

void protect_config(const PortOptions& port, Outputs& outputs) {
  for (const std::string& file : hal::config_files(port.config_file))
    outputs.protect("the configuration", file);
}

hal::Result<hal::ChosenRobot> find_plain_robot(const hal::Config& config) {
  hal::Config plain;
  plain.port = config.port;
  // GPIO lines are left alone, but opening the port moves its own.
  if (config.pins.brc.modem_line()) plain.pins.brc = config.pins.brc;
  if (config.pins.power_toggle.modem_line()) plain.pins.power_toggle = config.pins.power_toggle;
  auto chosen = hal::choose_robot(plain, {.boot_baud = *config.baud}, 0);
  if (chosen && chosen->create) {
    print_remark("no port is given: this is a virtual Create of its own, on " + chosen->port +
                 "; list the ports with: cargobay ports");
  }
  return chosen;
}

hal::Result<hal::ChosenRobot> choose_robot(const hal::Config& config, const PinOptions& pins,
                                           const hal::sim::Parameters& robot, int create_priority) {
  if (config.port.empty() && pins.any_line())
    return hal::Failure{"the pins of a robot need its --port"};
  return hal::choose_robot(config, robot, create_priority);
}

}  // namespace cargobay::cli
