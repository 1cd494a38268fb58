// A pair of wheel speeds. Forward is positive.
#pragma once

namespace cargobay::rt {

struct WheelSpeeds {
  double left_mm_s = 0.0;
  double right_mm_s = 0.0;
  friend constexpr bool operator==(const WheelSpeeds&, const WheelSpeeds&) = default;
};

}  // namespace cargobay::rt
