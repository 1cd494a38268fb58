// A pseudo-terminal tells what rate it is set to, not which bytes were written before it was. A
// host that sends Baud and sets its port at once would be taken to have sent it at the new rate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/baud.hpp"
#include "oi/commands.hpp"

namespace cargobay::hal::sim {

// How many of the bytes were written before the port was set to `baud`: as far as a Baud command
// that asks for this very rate, where there is one, else none.
constexpr std::size_t sent_before_change(std::span<const std::uint8_t> bytes, std::uint32_t baud) {
  const auto code = oi::baud_code(baud);
  if (!code) return 0;
  for (std::size_t end = bytes.size(); end >= 2; --end) {
    if (bytes[end - 2] == oi::Baud::kOpcode && bytes[end - 1] == *code) return end;
  }
  return 0;
}

}  // namespace cargobay::hal::sim
