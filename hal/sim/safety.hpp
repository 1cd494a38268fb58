// What makes Safe mode stop the robot and become Passive (OI p. 6).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/sim/inputs.hpp"
#include "hal/sim/pose.hpp"
#include "hal/sim/robot_parts.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {

enum class SafetyCondition : std::uint8_t { cliff, wheel_drop, charger };

constexpr std::string_view name(SafetyCondition condition) {
  switch (condition) {
    case SafetyCondition::cliff: return "cliff";
    case SafetyCondition::wheel_drop: return "wheel_drop";
    case SafetyCondition::charger: return "charger";
  }
  return "";
}

// Whether the robot drives toward what its cliff sensors, which are at the front, can see: forward,
// or in any direction around a centre within its own circle. `wheel_base_mm` is not 0.
inline bool cliffs_matter(WheelSpeeds commanded, double wheel_base_mm) {
  const double left = commanded.left_mm_s;
  const double right = commanded.right_mm_s;
  if (left == 0.0 && right == 0.0) return false;
  if (left + right > 0.0) return true;
  const double apart = std::abs(right - left);
  return 0.5 * wheel_base_mm * std::abs(right + left) < kRobotRadiusMm * apart;
}

// What Safe mode reacts to; nothing if all is well.
inline std::optional<SafetyCondition> safety_condition(const Inputs& seen, WheelSpeeds commanded,
                                                       double wheel_base_mm) {
  if (seen.any_wheel_drop()) return SafetyCondition::wheel_drop;
  if (seen.charger) return SafetyCondition::charger;
  if (seen.any_cliff() && cliffs_matter(commanded, wheel_base_mm)) return SafetyCondition::cliff;
  return std::nullopt;
}

}  // namespace cargobay::hal::sim
