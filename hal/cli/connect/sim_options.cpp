#include "hal/cli/connect/sim_options.hpp"

#include <span>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/terminal/in_range.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/control.hpp"
#include "hal/sim/remote/control_socket.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

constexpr const char* kGroup = "Virtual Create";

using hal::sim::PlantValue;
using hal::sim::WheelParameters;

CLI::Validator plant_validator() {
  return CLI::Validator{[](const std::string& text) {
                          WheelParameters wheels;
                          return hal::sim::set_plant(text, wheels);
                        },
                        ""};
}

// What it takes, as CLI11 words it for its own validators.
std::string taken_by(const PlantValue& value) {
  if (!value.is_number()) return "{" + hal::sim::range_of(value, ",") + "}";
  const std::string bounds = fmt::format("in [{} - {}]", value.range.least, value.range.most);
  return value.or_none ? "0, or " + bounds : "FLOAT " + bounds;
}

CLI::Validator value_validator(const PlantValue& value) {
  return CLI::Validator{[&value](const std::string& text) {
                          WheelParameters wheels;
                          return hal::sim::set_value(value, text, wheels);
                        },
                        taken_by(value)};
}

// Tried on a separate robot: only the robot knows what makes sense.
std::string try_later(const std::string& text) {
  hal::sim::Device device{{}};
  hal::sim::Cable cable{device};
  const std::string answer = hal::sim::control("at " + text, cable);
  constexpr std::string_view kError = "error: ";
  return answer.starts_with(kError) ? answer.substr(kError.size()) : "";
}

void add_wheel_options(CLI::App& app, SimOptions& options) {
  app.add_option("--plant", options.plant,
                 "How its wheels answer, and single values on top: 'slow dead-time 0.06'. A value "
                 "that is given as an option overrides both. The plants are " +
                     hal::sim::plant_names() + "; `cargobay sim --help` describes them")
      ->check(plant_validator())
      ->type_name("'NAME [VALUE NUMBER]...'")
      ->capture_default_str()
      ->group(kGroup);
  const std::span<const PlantValue> values = hal::sim::plant_values();
  options.plant_values.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    app.add_option("--" + std::string{values[i].name}, options.plant_values[i],
                   std::string{values[i].meaning})
        ->check(value_validator(values[i]))
        ->type_name(values[i].is_number() ? "FLOAT" : "TEXT")
        ->default_str(hal::sim::value_of(values[i], WheelParameters{}))
        ->group(kGroup);
  }
}

}  // namespace

void add_sim_options(CLI::App& app, SimOptions& options) {
  app.add_option("--remainder", options.remainder,
                 "What reading distance and angle does to the fraction below 1 mm or 1 degree")
      ->check(CLI::IsMember({"carried", "lost"}))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--checksum", options.checksum,
                 "Whether the checksum of stream frames covers the header 19: real robots include "
                 "it, the manual excludes it")
      ->check(CLI::IsMember({"including", "excluding"}))
      ->capture_default_str()
      ->group(kGroup);
  app.add_flag("--extensions", options.extensions,
               "Do what the firmware of 2007-09-24 does: raw counts in packets 43 and 44, its date "
               "on opcode 8, a reset on opcode 7")
      ->group(kGroup);
  app.add_option("--power-on", options.power_on,
                 "long-ago: it waits for Start; now: it boots, deaf for 3.5 s; never: it is off "
                 "until its button is pressed")
      ->check(CLI::IsMember({"long-ago", "now", "never"}))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--battery", options.parameters.battery.charge_mah,
                 "Charge of its battery, in mAh")
      ->check(in_range(1.0, options.parameters.battery.capacity_mah))
      ->capture_default_str()
      ->group(kGroup);
  app.add_flag("--no-charging-text", options.no_charging_text,
               "Do not print a line of text each second while charging")
      ->group(kGroup);
  app.add_option("--receiver-opening", options.parameters.receiver_opening_deg,
                 "Degrees around the front from which infrared reaches its receiver: less than 360 "
                 "is the tape that demos Home and Tag need")
      ->check(in_range(1.0, hal::sim::kAllAroundDeg))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--seed", options.parameters.seed, "Seed of everything random in it")
      ->check(whole_number())
      ->capture_default_str()
      ->group(kGroup);
  add_wheel_options(app, options);
  app.add_option("--at", options.later,
                 "Do this to it when it has run for so long: a command of its control socket, as "
                 "in --at '5 plant carpet' --at '8 load 0.5 left 150'; may be repeated")
      ->type_size(1)
      ->allow_extra_args(false)
      ->check(CLI::Validator{&try_later, "'SECONDS COMMAND'"})
      ->group(kGroup);
}

hal::sim::Parameters parameters(const SimOptions& options) {
  hal::sim::Parameters parameters = options.parameters;
  parameters.remainder =
      options.remainder == "lost" ? hal::sim::Remainder::lost : hal::sim::Remainder::carried;
  parameters.checksum = options.checksum == "excluding" ? oi::Checksum::excluding_header
                                                        : oi::Checksum::including_header;
  parameters.dialect = options.extensions ? &oi::kCreateWithExtensions : &oi::kCreate;
  if (options.power_on == "now") parameters.power_on = hal::sim::PowerOn::now;
  if (options.power_on == "never") parameters.power_on = hal::sim::PowerOn::never;
  parameters.charging_text = !options.no_charging_text;
  // The words were checked when they were parsed.
  (void)hal::sim::set_plant(options.plant, parameters.wheels);
  const std::span<const PlantValue> values = hal::sim::plant_values();
  for (std::size_t i = 0; i < options.plant_values.size(); ++i) {
    if (!options.plant_values[i].empty())
      (void)hal::sim::set_value(values[i], options.plant_values[i], parameters.wheels);
  }
  return parameters;
}

void schedule(const SimOptions& options, hal::sim::Server& server) {
  for (const std::string& text : options.later) (void)hal::sim::control("at " + text, server);
}

}  // namespace cargobay::cli
