// Home and Tag: to a virtual wall by a receiver that sees nothing but what is ahead (OI p. 8: its
// back and sides are covered with tape). The robot spins until the wall has come into sight and
// left it again: it is in the middle between these two headings, and the robot drives there.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/sim/demos/demo_view.hpp"

namespace cargobay::hal::sim {

class Homing {
 public:
  void start(const DemoView& view);
  // Looks for the next wall, behind it.
  void turn_around(const DemoView& view);
  // Past what it met with one side, and once more from there.
  void go_past(const DemoView& view);
  WheelSpeeds step(const DemoView& view);
  // It has seen a wall and is on its way there.
  bool on_its_way() const { return phase_ == Phase::drive && !searches_ && !evasion_.active(); }

 private:
  enum class Phase : std::uint8_t { spin, drive };

  void spin_from_here(const DemoView& view);
  // Turns there on the spot, and then drives.
  void drive_toward(const DemoView& view, double heading_deg);
  WheelSpeeds spin(const DemoView& view);
  WheelSpeeds drive(const DemoView& view);
  void next_leg(const DemoView& view);
  void search_elsewhere(const DemoView& view);
  void evade(const DemoView& view);
  bool is_the_last(double heading_deg) const;
  void reckon(const DemoView& view);

  Phase phase_ = Phase::spin;
  Evasion evasion_{};
  double side_ = 1.0;             // it spins to the left; -1 to the right
  double spin_deg_ = 0.0;         // where the spin began
  bool sees_ = false;             // at the last tick
  bool came_into_sight_ = false;  // in this spin, at that heading
  double came_deg_ = 0.0;
  double heading_deg_ = 0.0;     // it drives that way
  double unseen_mm_ = 0.0;       // where it last saw a wall, or began to drive
  double most_unseen_mm_ = 0.0;  // after so much more it spins again
  bool searches_ = false;        // it drives where it hopes to see a wall
  bool found_ = false;           // what it searched for
  double beside_mm_ = 0.0;       // to the left of its way
  bool turns_around_ = false;    // it has bumped into a wall at that heading
  double bumped_deg_ = 0.0;
  bool went_around_ = false;  // that wall, and saw no other before
  std::size_t legs_ = 0;      // of the way around it, begun
  bool went_past_ = false;    // what it met with one side at that heading
  double past_deg_ = 0.0;
  // By its own reckoning, from where it saw a wall last: so far, and there it is.
  bool ever_saw_ = false;
  double x_mm_ = 0.0;
  double y_mm_ = 0.0;
  double last_travelled_mm_ = 0.0;
  double last_turned_deg_ = 0.0;
};

}  // namespace cargobay::hal::sim
