// The configuration file: port, pins, the robot's parameters and real-time wishes, as TOML
// (docs/wiring.md has an example).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/bring_up/open_pins.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

// What no file says is empty, or as the defaults have it.
struct Config {
  std::string port{};
  std::optional<std::uint32_t> baud{};
  PinSettings pins{};
  std::optional<double> wheel_base_mm{};
  std::optional<double> distance_scale{};  // true distance for each mm that the robot reports
  std::optional<double> turn_scale{};      // the same for each degree
  std::optional<double> lag_s{};
  std::optional<double> acceleration_mm_s2{};
  std::optional<double> jerk_mm_s3{};  // not said: none
  std::optional<rt::Remainder> remainder{};
  std::optional<int> priority{};
  std::optional<int> cpu{};
  bool require_realtime = false;
};

// Reads the text on top of `config`. A wrong key or value is a failure that names `file` and line,
// and the nearest key; `config` is then half changed.
std::optional<Failure> read_config(std::string_view text, const std::string& file, Config& config);

// `file`, or where it is empty /etc/cargobay.toml and on top of it $XDG_CONFIG_HOME/cargobay.toml
// (~/.config where that is not set), as far as they exist.
std::vector<std::string> config_files(const std::string& file);

// Reads config_files(), the last on top. Each is read as hal/file/read_input.hpp says, up to 1 MiB.
Result<Config> load_config(const std::string& file);

// What the robot's parameters change of the loop's.
void apply(const Config& config, CycleParameters& parameters);

}  // namespace cargobay::hal
