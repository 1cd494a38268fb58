// What users may set: the ranges, stated once for configuration file, C API and command.
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

// Of the robot. Tight enough that a value given in metres is out of range.
inline constexpr Range kWheelBaseMm{50.0, 1000.0};
inline constexpr Range kScale{0.5, 2.0};
inline constexpr Range kLagS{0.001, 10.0};
inline constexpr Range kAccelerationMmS2{1.0, 100'000.0};
inline constexpr Range kJerkMmS3{1.0, 10'000'000.0};
// Of the loop.
inline constexpr Range kPriority{1, 98};  // 99 is for threads that the kernel cannot do without
inline constexpr Range kCpu{0, 1023};
inline constexpr Range kSetpointLapseMs{20, 60'000};
inline constexpr Range kControlBudgetUs{10, 1'000'000};
inline constexpr Range kControlOverruns{1, 1'000'000};
inline constexpr Range kLinkTimeoutMs{200, 600'000};
inline constexpr Range kGuardDeadlineMs{40, 10'000};
// Of the virtual Create.
inline constexpr Range kDroop{0.0, 0.9};
inline constexpr Range kNoiseMmS{0.0, 100.0};

}  // namespace cargobay::hal
