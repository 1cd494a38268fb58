// Where the parts of the robot are, seen from its centre; angles count to the left of ahead. The
// cliff sensors and the caster are where TurtleBot's description of the Create has them
// (turtlebot_create, create.urdf.xacro).
#pragma once

namespace cargobay::hal::sim {

inline constexpr double kRobotRadiusMm = 165.0;

// The sensors on the left; those on the right mirror them.
inline constexpr double kCliffFrontMm = 155.0;
inline constexpr double kCliffFrontDeg = 15.0;
inline constexpr double kCliffSideMm = 156.5;
inline constexpr double kCliffSideDeg = 63.4;
inline constexpr double kWallSensorDeg = -65.0;

inline constexpr double kCasterMm = 130.0;
// A wheel rests on floor that is so close to where it stands. The caster, 18 mm in radius, then
// hangs 4 mm low.
inline constexpr double kWheelRestsMm = 12.0;

}  // namespace cargobay::hal::sim
