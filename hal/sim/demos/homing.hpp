// Home and Tag: to a virtual wall by a receiver that sees nothing but what is ahead (OI p. 8: its
// back and sides are covered with tape). The robot spins until the wall has come into sight and
// left it again: it is in the middle between these two headings, and the robot drives there.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/sim/demos/demo_view.hpp"
#include "hal/sim/demos/floor_memory.hpp"

namespace cargobay::hal::sim {

class Homing {
 public:
  void start(const DemoView& view);
  // On its way it has met something. If that is straight ahead, it is the wall: it turns around and
  // looks for the next one. What it meets with one side is not, and it goes past that.
  void meet(const DemoView& view, const FloorMemory& floor);
  // `floor` is of this tick.
  WheelSpeeds step(const DemoView& view, FloorMemory& floor);
  // It has seen a wall and is on its way there.
  bool on_its_way() const { return phase_ == Phase::drive && !evasion_.active(); }

 private:
  enum class Phase : std::uint8_t { spin, drive, search };

  void turn_around(const DemoView& view);
  void go_past(const DemoView& view);
  void spin_from_here(const DemoView& view);
  // Turns there on the spot, and then drives.
  void drive_toward(const DemoView& view, double heading_deg);
  void drive_on_line(const DemoView& view);
  WheelSpeeds spin(const DemoView& view, FloorMemory& floor);
  WheelSpeeds drive(const DemoView& view);
  WheelSpeeds search(const DemoView& view, FloorMemory& floor);
  void search_elsewhere(const FloorMemory& floor);
  FloorMemory::Place from_met(double ahead_mm) const;
  bool choose(const DemoView& view, FloorMemory& floor);
  bool is_the_last(const FloorMemory& floor, double heading_deg) const;
  void met(const FloorMemory& floor);
  void reckon(const DemoView& view, const FloorMemory& floor);

  Phase phase_ = Phase::spin;
  static constexpr double kAimMmPerSec = 120.0;  // it must not turn too far

  Evasion evasion_{kAimMmPerSec};
  double side_ = 1.0;             // it spins to the left; -1 to the right
  double spin_deg_ = 0.0;         // where the spin began
  bool sees_ = false;             // at the last tick
  bool came_into_sight_ = false;  // in this spin, at that heading
  double came_deg_ = 0.0;
  double heading_deg_ = 0.0;     // it drives that way
  double unseen_mm_ = 0.0;       // where it last saw a wall, or began to drive
  double most_unseen_mm_ = 0.0;  // after so much more it spins again
  double beside_mm_ = 0.0;       // to the left of its way
  double last_travelled_mm_ = 0.0;
  double last_turned_deg_ = 0.0;

  // What it met last on its way to a wall.
  bool has_met_ = false;
  FloorMemory::Place met_{};
  double met_deg_ = 0.0;  // the heading then

  // Where it looks for the next one: at places along the way it came from or went to, then at new
  // ones.
  std::size_t place_ = 0;
  std::uint32_t bumps_ = 0;  // on its way to this one
  FloorMemory::Place to_{};  // on that way
  double look_mm_ = 0.0;     // of its way: it has spun there
  rt::Duration chosen_at_{0};
  // Where it saw a wall last.
  bool ever_saw_ = false;
  FloorMemory::Place saw_{};
  MeanPlace middle_{};       // of all places where it did
  double counted_mm_ = 0.0;  // of its way, when it counted one last
};

}  // namespace cargobay::hal::sim
