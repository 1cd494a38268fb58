// The two axes in which a robot reports how far it went.
#pragma once

namespace cargobay::rt {

// A choice of them.
struct Axes {
  bool distance = false;
  bool turn = false;
  friend constexpr bool operator==(const Axes&, const Axes&) = default;
  constexpr bool any() const { return distance || turn; }
  constexpr bool both() const { return distance && turn; }
};
inline constexpr Axes kBothAxes{.distance = true, .turn = true};

}  // namespace cargobay::rt
