// Where the robot is, and how fast its wheels turn.
#pragma once

#include "rt/wheel_speeds.hpp"

namespace cargobay::hal::sim {

using rt::WheelSpeeds;

// Where the robot really is, on the floor: x points ahead and y to the left of where it stood at
// the beginning, counter-clockwise positive.
struct WorldPose {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double heading_rad = 0.0;
};

}  // namespace cargobay::hal::sim
