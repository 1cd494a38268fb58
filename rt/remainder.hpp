// Reading packet 19 or 20 takes whole millimetres or degrees; a fraction remains. Robots of both
// kinds exist (docs/protocol.md).
#pragma once

#include <cstdint>

namespace cargobay::rt {

// What reading does to that fraction of a step.
enum class Remainder : std::uint8_t {
  carried,  // it counts towards the next reading
  lost,     // it is gone
};

// What is known about it.
enum class RemainderBelief : std::uint8_t { unknown, carried, lost };

}  // namespace cargobay::rt
