// The twelve baud rates of the Open Interface (opcode 129, OI p. 7).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace cargobay::oi {

// Indexed by baud code.
inline constexpr std::array<std::uint32_t, 12> kBaudRates{
    300, 600, 1200, 2400, 4800, 9600, 14400, 19200, 28800, 38400, 57600, 115200};
inline constexpr std::uint32_t kDefaultBaud = 57600;
inline constexpr std::uint32_t kBrcBaud = 19200;  // after three pulses on the Baud Rate Change pin

// The code of a baud rate; nothing for a rate that the robot does not know.
constexpr std::optional<std::uint8_t> baud_code(std::uint32_t baud) {
  for (std::size_t code = 0; code < kBaudRates.size(); ++code) {
    if (kBaudRates[code] == baud) return static_cast<std::uint8_t>(code);
  }
  return std::nullopt;
}

}  // namespace cargobay::oi
