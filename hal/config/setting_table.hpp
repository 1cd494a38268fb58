// The settings of the configuration file, one row each: what reads the file, hands its values to
// the loop, and makes the manual page and the example file.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "hal/config/config.hpp"
#include "hal/config/settings.hpp"
#include "hal/cycle/cycle_parameters.hpp"

namespace cargobay::hal {

// Where a value goes; its type says what the file may hold.
using SettingMember =
    std::variant<std::string Config::*,                   // a text
                 std::optional<std::uint32_t> Config::*,  // one of the robot's baud rates
                 std::optional<double> Config::*,         // a number
                 std::optional<int> Config::*,            // a whole number
                 std::optional<rt::Remainder> Config::*,  // "carried" or "lost"
                 bool Config::*>;

struct Setting {
  std::string_view table;  // empty: at the top of the file
  std::string_view key;
  SettingMember member;
  std::optional<Range> range{};  // of numbers
  std::string_view unit{};       // of the range
  std::string_view not_unit{};   // that people take it for: "not metres"
  std::span<const Mistake> mistakes{};
  std::string_view meaning{};   // without a full stop
  std::string_view left_out{};  // its default, or what happens without it
  std::string_view example{};   // a value, as TOML
  // Hands it to the loop; null if it is not one of the loop's.
  void (*apply)(const Config& config, CycleParameters& parameters) = nullptr;
};

std::span<const Setting> settings();

// The setting of that key, which must be one.
const Setting& setting_named(std::string_view key);

}  // namespace cargobay::hal
