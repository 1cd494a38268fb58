// The twelve baud rates of the Open Interface (opcode 129, OI p. 7).
#pragma once

#include <array>
#include <cstdint>

namespace cargobay::oi {

// Indexed by baud code.
inline constexpr std::array<std::uint32_t, 12> kBaudRates{
    300, 600, 1200, 2400, 4800, 9600, 14400, 19200, 28800, 38400, 57600, 115200};

}  // namespace cargobay::oi
