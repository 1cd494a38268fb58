// What kind of robot the virtual Create is. The defaults are a robot as owners describe theirs.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/sim/battery.hpp"
#include "hal/sim/wheel_parameters.hpp"
#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"
#include "rt/remainder.hpp"

namespace cargobay::hal::sim {

using rt::Remainder;

inline constexpr double kAllAroundDeg = 360.0;
inline constexpr rt::Duration kPowerOnTime = std::chrono::milliseconds{3500};  // deaf, booting

// The state in which the robot is found.
enum class PowerOn : std::uint8_t {
  long_ago,  // it has booted, and waits for Start
  now,       // it boots: deaf for 3.5 s
  never,     // it is off until its button is pressed
};

struct Parameters {
  Remainder remainder = Remainder::carried;
  oi::Checksum checksum = oi::Checksum::including_header;  // of stream frames
  std::uint32_t boot_baud =
      oi::kCreate.default_baud;  // 57600 or 19200 (OI p. 5); any rate is accepted
  std::uint64_t seed = 1;
  rt::Duration first_tick = oi::kTick;  // from power-on; then every 15 ms
  std::size_t transmit_bytes = 1024;    // room for bytes waiting to be sent; more are lost
  // What firmware of 2007-09-24 has beyond the manual: packets 43 and 44, opcodes 7 and 8.
  const oi::Dialect* dialect = &oi::kCreate;
  PowerOn power_on = PowerOn::long_ago;
  bool charging_text = true;  // while charging, a line of text each second among the replies
  // How wide the infrared receiver sees, centred on the front. Less than 360 is a receiver with
  // tape over its back and sides, as the demos Home and Tag ask for (OI p. 8).
  double receiver_opening_deg = kAllAroundDeg;
  WheelParameters wheels{};
  BatteryParameters battery{};
};

}  // namespace cargobay::hal::sim
