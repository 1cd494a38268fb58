#include "hal/cli/connect/sim_options.hpp"

#include <CLI/CLI.hpp>

#include "hal/cli/terminal/in_range.hpp"
#include "hal/config/settings.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

constexpr const char* kGroup = "Virtual Create";

void add_wheel_options(CLI::App& app, hal::sim::WheelParameters& wheels) {
  app.add_option("--lag", wheels.lag_s, "Seconds a wheel takes to come within 37 % of a new speed")
      ->check(in_range(hal::kLagS.least, hal::kLagS.most))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--droop-left", wheels.droop_left,
                 "Fraction by which the left wheel falls short of its set speed")
      ->check(in_range(hal::kDroop.least, hal::kDroop.most))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--droop-right", wheels.droop_right, "The same for the right wheel")
      ->check(in_range(hal::kDroop.least, hal::kDroop.most))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--dead-band", wheels.dead_band_mm_s,
                 "Set speeds below this, in mm/s, do not turn a wheel")
      ->check(in_range(0.0, 500.0))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--counts-per-mm", wheels.counts_per_mm, "Resolution of the encoders")
      ->check(in_range(0.01, 1000.0))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--wheel-base", wheels.wheel_base_mm, "Distance between its wheels, in mm")
      ->check(in_range(hal::kWheelBaseMm.least, hal::kWheelBaseMm.most))
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--noise", wheels.noise_mm_s,
                 "Standard deviation in mm/s by which a wheel's speed wanders")
      ->check(in_range(hal::kNoiseMmS.least, hal::kNoiseMmS.most))
      ->capture_default_str()
      ->group(kGroup);
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
  add_wheel_options(app, options.parameters.wheels);
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
  return parameters;
}

}  // namespace cargobay::cli
