// The floor of a room in cells of 50 mm: where a robot can get to, and what it has passed over.
#pragma once

#include <cstddef>
#include <vector>

#include "hal/sim/pose.hpp"
#include "tests/campaign/random_room.hpp"

namespace cargobay::campaign {

// A passage counts if it leaves this much room on either side of the robot.
inline constexpr double kPassageSlackMm = 50.0;

class FloorMap {
 public:
  // Where a robot that avoids stairs and virtual walls can get to from its start.
  explicit FloorMap(const RandomRoom& room);

  // Whether its centre can get there.
  bool reaches(hal::sim::Point at) const;
  // The robot is here: its whole body, 330 mm across, covers the floor.
  void pass(const hal::sim::WorldPose& pose);
  // The covered part of the floor that can be covered, 0 to 1.
  double covered_share() const;

 private:
  struct Cell {
    bool free = false;     // the centre of a robot can be here
    bool roomy = false;    // with the slack all around
    bool reached = false;  // from the start
    bool floor = false;    // under a robot at some place it can get to
    bool covered = false;
  };

  void look_at(const RandomRoom& room);
  void spread(hal::sim::Point start);
  void widen();
  hal::sim::Point centre(std::size_t index) const;
  std::size_t index_of(hal::sim::Point at) const;  // cells_.size() outside
  // Calls visit(index) for each cell whose centre is that close.
  template <typename Visit>
  void visit_around(hal::sim::Point at, double radius_mm, Visit&& visit) const;

  hal::sim::Point corner_{};
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<Cell> cells_{};
};

}  // namespace cargobay::campaign
