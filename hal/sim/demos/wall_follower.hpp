// Along a wall with the wall on the right, by the wall sensor and the bumper: what Mouse does, and
// Cover now and then.
#pragma once

#include "hal/sim/demos/demo_view.hpp"

namespace cargobay::hal::sim {

class WallFollower {
 public:
  // Where the robot has just met something.
  void start(const DemoView& view);
  WheelSpeeds step(const DemoView& view);
  // It has turned right all around and found no wall again.
  bool lost() const { return lost_; }

 private:
  void meet(const DemoView& view);

  Evasion evasion_{};
  bool lost_ = false;
  bool in_beam_ = false;       // of a virtual wall, at the last tick
  double around_mm_ = 0.0;     // the radius of the arc back to what it has left
  double left_wall_mm_ = 0.0;  // the places where it saw it last
  double left_wall_deg_ = 0.0;
  double met_beam_mm_ = 0.0;
};

}  // namespace cargobay::hal::sim
