// Ranges of numbers that users give, and those that the loop and the virtual Create share.
#pragma once

#include <array>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

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

// A unit that people take a number's for, and how many of the right one it is.
struct Mistake {
  std::string_view unit;
  double factor;
};
inline constexpr std::array kNotMm{Mistake{"metres", 1e3}, Mistake{"centimetres", 10.0},
                                   Mistake{"inches", 25.4}};
inline constexpr std::array kNotMmS{Mistake{"metres per second", 1e3}};
inline constexpr std::array kNotMmS2{Mistake{"m/s^2", 1e3}};
inline constexpr std::array kNotMmS3{Mistake{"m/s^3", 1e3}};
inline constexpr std::array kNotSeconds{Mistake{"milliseconds", 1e-3},
                                        Mistake{"microseconds", 1e-6}};
inline constexpr std::array kNotMs{Mistake{"seconds", 1e3}, Mistake{"microseconds", 1e-3}};
inline constexpr std::array kNotNs{Mistake{"seconds", 1e9}, Mistake{"milliseconds", 1e6},
                                   Mistake{"microseconds", 1e3}};
inline constexpr std::array kNotPart{Mistake{"percent", 1e-2}};

// For a value out of `range`: "; metres? did you mean 258" if it makes sense in one of these units,
// else "".
inline std::string likely_meaning(const Range& range, std::span<const Mistake> mistakes,
                                  double value) {
  for (const Mistake& mistake : mistakes) {
    const double meant = value * mistake.factor;
    if (value == 0.0 || !range.contains(meant)) continue;
    std::ostringstream text;
    text.precision(12);
    text << "; " << mistake.unit << "? did you mean " << meant;
    return text.str();
  }
  return "";
}

// Of a robot. Tight enough that a value in another unit is out of range.
inline constexpr Range kWheelBaseMm{50.0, 1000.0};
inline constexpr Range kLagS{0.001, 1.0};

}  // namespace cargobay::hal
