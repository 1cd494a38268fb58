// What users may set: the ranges, stated once for configuration file, C API and command.
#pragma once

#include "hal/range.hpp"

namespace cargobay::hal {

// Of the robot.
inline constexpr Range kScale{0.5, 2.0};
inline constexpr Range kErrorPart{0.0, 0.2};
inline constexpr Range kAccelerationMmS2{10.0, 100'000.0};
inline constexpr Range kJerkMmS3{20.0, 10'000'000.0};
// Of the loop.
inline constexpr Range kPriority{1, 98};  // 99 is for threads that the kernel cannot do without
inline constexpr Range kCpu{0, 1023};
inline constexpr Range kSetpointLapseMs{20, 60'000};
inline constexpr Range kControlBudgetUs{10, 1'000'000};
inline constexpr Range kControlOverruns{1, 1'000'000};
inline constexpr Range kLinkTimeoutMs{200, 600'000};
inline constexpr Range kGuardDeadlineMs{40, 10'000};

}  // namespace cargobay::hal
