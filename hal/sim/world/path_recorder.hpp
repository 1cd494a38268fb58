// The path of a robot, in bounded memory: one that becomes too long is thinned out evenly over its
// whole length.
#pragma once

#include <cstddef>
#include <vector>

#include "hal/sim/pose.hpp"

namespace cargobay::hal::sim {

struct Waypoint {
  WorldPose pose{};
  bool placed = false;  // put there: the robot did not drive there from the waypoint before
  bool bumped = false;  // its bumper was pushed, and was not at the tick before
};

class PathRecorder {
 public:
  // Keeps at most `most` waypoints; the least is four.
  explicit PathRecorder(std::size_t most = 16384);

  // The robot's pose; call it once a tick.
  void add(const WorldPose& pose, bool bumper_pushed);
  // From the first place to the last, both included.
  std::vector<Waypoint> path() const;

 private:
  void thin_out();

  std::size_t most_;
  double spacing_mm_ = 5.0;  // between waypoints; doubled at each thinning
  bool pushed_ = false;      // at the tick before
  std::vector<Waypoint> kept_{};
  Waypoint last_{};  // where the robot is now
};

}  // namespace cargobay::hal::sim
