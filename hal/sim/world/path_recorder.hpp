// The way a robot took, in bounded memory: one that becomes too long is thinned out, over all its
// length alike.
#pragma once

#include <cstddef>
#include <vector>

#include "hal/sim/wheels.hpp"

namespace cargobay::hal::sim {

struct Waypoint {
  Pose pose{};
  bool placed = false;  // put there: it did not drive there from the waypoint before
  bool bumped = false;  // its bumper was pushed, for the first time in a row
};

class PathRecorder {
 public:
  // Keeps at most so many waypoints, and no fewer than four.
  explicit PathRecorder(std::size_t most = 16384);

  // Where it is, once a tick.
  void add(const Pose& pose, bool bumper_pushed);
  // From the first place to the last one, both of them included.
  std::vector<Waypoint> path() const;

 private:
  void thin_out();

  std::size_t most_;
  double spacing_mm_ = 5.0;  // between waypoints; doubled where they are thinned out
  bool pushed_ = false;      // at the tick before
  std::vector<Waypoint> kept_{};
  Waypoint last_{};  // where it is now
};

}  // namespace cargobay::hal::sim
