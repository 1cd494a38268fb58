// Velocity and turn rate of a robot with two wheels, and the wheel speeds that make them.
#pragma once

#include <algorithm>
#include <cmath>

#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

struct Twist {
  double velocity_mm_s = 0.0;    // of the middle between the wheels
  double turn_rate_rad_s = 0.0;  // counter-clockwise
};

// If a wheel would have to go faster than `most_mm_s`, both are scaled down together, so that the
// path stays the same. Not a number if the twist is not.
inline WheelSpeeds wheels_for(const Twist& twist, double wheel_base_mm, double most_mm_s)
    CARGOBAY_NONBLOCKING {
  const double half_base_mm = wheel_base_mm / 2.0;
  // First to where nothing overflows, however large the numbers are.
  const double scale = std::max({1.0, std::abs(twist.velocity_mm_s) / most_mm_s,
                                 std::abs(twist.turn_rate_rad_s) / (most_mm_s / half_base_mm)});
  const double velocity_mm_s = twist.velocity_mm_s / scale;
  const double apart_mm_s = twist.turn_rate_rad_s / scale * half_base_mm;
  const WheelSpeeds wheels{velocity_mm_s - apart_mm_s, velocity_mm_s + apart_mm_s};
  const double fastest_mm_s = std::max(std::abs(wheels.left_mm_s), std::abs(wheels.right_mm_s));
  // The faster wheel is to do all it can, if it was to do more.
  const double wanted_mm_s = fastest_mm_s * scale;
  if (!(wanted_mm_s > most_mm_s)) return wheels;
  const auto scaled = [&](double speed_mm_s) {
    return std::clamp(speed_mm_s / fastest_mm_s * most_mm_s, -most_mm_s, most_mm_s);
  };
  return {scaled(wheels.left_mm_s), scaled(wheels.right_mm_s)};
}

}  // namespace cargobay::rt
