// Sensor packets as people type them.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "oi/dialect.hpp"

namespace cargobay::oi {

// The packet of the dialect with this key or number (decimal, or hexadecimal after 0x); nothing if
// no packet has it.
std::optional<std::uint8_t> packet_named(std::string_view key_or_number,
                                         const Dialect& dialect = kCreate);

}  // namespace cargobay::oi
