// The state of the robot's outputs: LEDs, digital outputs, low side drivers, infrared (OI p. 9 to
// 11).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "oi/command_table.hpp"
#include "oi/commands.hpp"

namespace cargobay::hal::sim {

inline constexpr std::uint8_t kFullDuty = 128;
inline constexpr std::uint8_t kAllOutputs =
    oi::kCommandInfo<oi::DigitalOutputs::kOpcode>.argument_slots[0].mask;

struct Actuators {
  oi::Leds leds{};
  std::uint8_t digital_outputs = 0;                // one bit each, bit 0 is output 0
  std::array<std::uint8_t, 3> low_side_drivers{};  // duty, 0 to 128, of drivers 0 to 2
  std::optional<std::uint8_t> infrared_sent{};     // by the last Send IR
  std::uint64_t infrared_count = 0;

  bool lit(oi::Led led) const { return leds.leds.has(led); }
  // All on or off, one bit per driver.
  void switch_low_side_drivers(std::uint8_t bits) {
    for (unsigned i = 0; i < low_side_drivers.size(); ++i) {
      low_side_drivers[i] =
          ((static_cast<unsigned>(bits) >> i) & 1U) != 0 ? kFullDuty : std::uint8_t{0};
    }
  }
  void set_low_side_drivers(std::array<std::uint8_t, 3> duty) {
    for (unsigned i = 0; i < low_side_drivers.size(); ++i) {
      low_side_drivers[i] = std::min(duty[i], kFullDuty);
    }
  }
  void send_infrared(std::uint8_t byte) {
    infrared_sent = byte;
    ++infrared_count;
  }
};

}  // namespace cargobay::hal::sim
