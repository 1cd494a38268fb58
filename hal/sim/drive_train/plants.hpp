// Kinds of wheels by name, and their single values, one row each: what command line, control
// socket, C API, state and documentation know of them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "hal/range.hpp"
#include "hal/sim/wheel_parameters.hpp"

namespace cargobay::hal::sim {

inline constexpr Range kGain{0.1, 1.5};
inline constexpr Range kNoiseMmS{0.0, 100.0};
inline constexpr Range kLoad{0.0, 2.0};  // 0: nothing of the gain is left

struct Unit {
  std::string_view words;  // "in seconds"
  std::span<const Mistake> mistakes{};
};

struct PlantValue {
  std::string_view name;  // "dead-time"
  std::variant<double WheelParameters::*, Response WheelParameters::*,
               CounterSign WheelParameters::*>
      member;
  std::string_view meaning;
  Range range{};  // of a number
  Unit unit{};
  bool or_none = false;  // 0 is in the range too, and means that there is none

  constexpr bool is_number() const { return member.index() == 0; }
};

struct Plant {
  std::string_view name;
  std::string_view meaning;
  WheelParameters parameters;  // wheel base and encoders are not its own
};

std::span<const PlantValue> plant_values();
std::span<const Plant> plants();
// "default slow heavy ...".
std::string plant_names();

// "0.001 to 10", "0, or 10 to 100000", "first-order or counting".
std::string range_of(const PlantValue& value, std::string_view between_choices = " or ");
// As it would be typed: "0.1", "counting".
std::string value_of(const PlantValue& value, const WheelParameters& parameters);
// Sets it. Empty, or what is wrong: "lag is in seconds, 0.001 to 1; milliseconds? did you mean
// 0.1"; then nothing has changed.
std::string set_value(const PlantValue& value, std::string_view word, WheelParameters& parameters);
// "[NAME] [VALUE NUMBER]...": a kind of wheels, or single values on top, as in "slow dead-time
// 0.06". Wheel base and encoders stay. Empty, or what is wrong; then nothing has changed.
std::string set_plant(std::string_view words, WheelParameters& parameters);
// The name of the kind of wheels with just these values, whatever wheel base and encoders; nothing
// if none has a name.
std::optional<std::string_view> plant_name(const WheelParameters& parameters);

}  // namespace cargobay::hal::sim
