// How far the wheels have taken the robot, and how sure that is.
#pragma once

namespace cargobay::rt {

struct Travel {
  double distance_mm = 0.0;  // ahead
  double turn_rad = 0.0;     // counter-clockwise
  // The part of the turn that was not foreseen: a reading has found it, and it has come about since
  // the reading before, evenly.
  double turn_corrected_rad = 0.0;
  // Of this step, and permanent: no later step makes up for it. mm^2 and rad^2.
  double distance_variance = 0.0;
  double turn_variance = 0.0;
  // Of all steps since the counters were last read; the next reading settles it.
  double unread_distance_variance = 0.0;
  double unread_turn_variance = 0.0;
};

// The same for either kind of robot (rt/remainder.hpp).
struct Travels {
  Travel if_carried{};
  Travel if_lost{};
};

}  // namespace cargobay::rt
