// The configuration file: port, pins, the robot's parameters and the real-time settings, as TOML
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

// Members that no file sets are empty, or have their default.
struct Config {
  std::string port{};
  std::optional<std::uint32_t> baud{};
  PinSettings pins{};
  std::optional<double> wheel_base_mm{};
  std::optional<double> distance_scale{};  // true distance per mm that the robot reports
  std::optional<double> turn_scale{};      // true angle per degree that the robot reports
  std::optional<double> lag_s{};
  std::optional<double> acceleration_mm_s2{};
  std::optional<double> jerk_mm_s3{};  // not set: no limit
  std::optional<rt::Remainder> remainder{};
  std::string learnt{};  // as learnt_place() has it
  bool hold_heading = false;
  std::optional<double> wheel_error{};  // part of its way that a wheel may be wrong by for good
  std::optional<double> wheel_base_error{};
  bool stop_if_implausible = true;  // if a wheel is stuck, or the counters cannot be true
  std::optional<int> priority{};
  std::optional<int> cpu{};
  bool require_realtime = false;
};

// Reads the text over `config`. A wrong key or value is a failure that names `file`, the line, and
// the nearest key; `config` is then partly changed.
Result<void> read_config(std::string_view text, const std::string& file, Config& config);

// `file` or, if that is empty, /etc/cargobay.toml and over it $XDG_CONFIG_HOME/cargobay.toml
// (~/.config if the variable is not set), whichever of them exist.
std::vector<std::string> config_files(const std::string& file);

// Reads config_files(), later ones over earlier ones; each as in hal/file/read_input.hpp, up to
// 1 MiB.
Result<Config> load_config(const std::string& file);

// Copies the robot's parameters into those of the loop.
void apply(const Config& config, CycleParameters& parameters);

}  // namespace cargobay::hal
