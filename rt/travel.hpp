// How far the wheels have taken the robot, and how sure that is.
#pragma once

namespace cargobay::rt {

struct Travel {
  double distance_mm = 0.0;  // ahead
  double turn_rad = 0.0;     // counter-clockwise
  // Of this step, and not to be made good by a later one: mm^2 and rad^2.
  double distance_variance = 0.0;
  double turn_variance = 0.0;
  // Of all steps so far, until the counters are read: the next steps take it back.
  double unread_distance_variance = 0.0;
  double unread_turn_variance = 0.0;
};

}  // namespace cargobay::rt
