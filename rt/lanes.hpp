// Four numbers at a time: what the compiler calls a vector, which it adds and multiplies by single
// instructions where the machine has them, and one by one elsewhere. (GCC manual, Vector
// Extensions; Clang knows them too.)
#pragma once

#include <cmath>
#include <cstddef>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

using Lanes = float __attribute__((vector_size(16)));
inline constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(float);

inline Lanes all_lanes(float value) CARGOBAY_NONBLOCKING { return Lanes{} + value; }

inline float sum(const Lanes& lanes) CARGOBAY_NONBLOCKING {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}
inline Lanes least(const Lanes& a, const Lanes& b) CARGOBAY_NONBLOCKING { return a < b ? a : b; }
inline Lanes greatest(const Lanes& a, const Lanes& b) CARGOBAY_NONBLOCKING { return a > b ? a : b; }
inline Lanes magnitude(const Lanes& lanes) CARGOBAY_NONBLOCKING { return greatest(lanes, -lanes); }
inline Lanes root(const Lanes& lanes) CARGOBAY_NONBLOCKING {
  return Lanes{std::sqrt(lanes[0]), std::sqrt(lanes[1]), std::sqrt(lanes[2]), std::sqrt(lanes[3])};
}

}  // namespace cargobay::rt
