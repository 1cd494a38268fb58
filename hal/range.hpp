// Ranges of numbers that users give, and those that the loop and the virtual Create share.
#pragma once

#include <sstream>
#include <string>

namespace cargobay::hal {

struct Range {
  double least = 0.0;
  double most = 0.0;

  constexpr bool contains(double value) const {  // false for NaN
    return value >= least && value <= most;
  }
  // In a unit of which there are `factor` to each of this one.
  constexpr Range times(double factor) const { return {least * factor, most * factor}; }
  // "50 to 1000".
  std::string words() const {
    std::ostringstream text;
    text.precision(12);
    text << least << " to " << most;
    return text.str();
  }
};

// Of a robot. Tight enough that a value given in metres is out of range.
inline constexpr Range kWheelBaseMm{50.0, 1000.0};
inline constexpr Range kLagS{0.001, 10.0};

}  // namespace cargobay::hal
