// The way onto a Home Base by what the robot sees of it: which of the two buoys light the receiver,
// and the force field (packet 17), its bumper, and its own wheels.
//
// The receiver sees all around and tells no direction. But a buoy's light ends along a straight
// line that leads to the base. Two places on one of these lines, by the robot's own reckoning, tell
// which way it runs; and which buoy is on which side of it, which end of it is the base. Where it
// has not met such a line twice, all that it has seen so far tells where the base is (BaseBelief).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/sim/demos/base_belief.hpp"
#include "hal/sim/demos/demo_view.hpp"
#include "hal/sim/demos/floor_memory.hpp"
#include "hal/sim/random.hpp"

namespace cargobay::hal::sim {

class Docking {
 public:
  // A demo begins: it has seen nothing.
  void reset(const DemoView& view);
  // At each tick, docking or not: where it is, and what it sees there.
  void watch(const DemoView& view, const FloorMemory& floor);
  // All that it saw fits one place only.
  bool knows_base() const { return belief_.estimate().has_value(); }
  // Where it sees something of a base, or knows it.
  void start(const DemoView& view);
  bool active() const { return active_; }
  // Not active any longer if it gave up.
  WheelSpeeds step(const DemoView& view, FloorMemory& floor);

 private:
  // Where the light of one buoy ends, in the light of the other.
  struct Edge {
    bool known = false;
    double x_mm = 0.0;
    double y_mm = 0.0;
  };

  // Where it drives straight now, and since when.
  struct Leg {
    FloorMemory::Place to{};
    rt::Duration chosen_at{0};
  };

  // After it has turned it drives straight, whatever it sees.
  struct Straight {
    double mm = 0.0;
    double end_mm = 0.0;  // of its way
    double deg = 0.0;
  };

  void look(const DemoView& view);
  void cross(oi::HomeBaseBeams from, oi::HomeBaseBeams to);
  void forget();
  double beside_line_mm() const;
  double ahead_mm(const DemoView& view) const;
  void correct_line(double away_mm);
  bool take_way_in(const DemoView& view, const FloorMemory& floor, const BaseBelief::Place& base);
  WheelSpeeds to_way_in(const DemoView& view, FloorMemory& floor, const BaseBelief::Place& base);
  WheelSpeeds approach(const DemoView& view, FloorMemory& floor);
  WheelSpeeds circle(const DemoView& view, FloorMemory& floor);
  WheelSpeeds leg(const DemoView& view) const;
  std::optional<FloorMemory::Place> promising(FloorMemory& floor);
  static FloorMemory::Place in_front(const BaseBelief::Place& base, double away_mm);
  WheelSpeeds explore(const DemoView& view, FloorMemory& floor);
  WheelSpeeds head_for(const DemoView& view, FloorMemory::Place place);
  bool at(FloorMemory::Place place) const;
  WheelSpeeds meet(const DemoView& view);
  WheelSpeeds evade(const DemoView& view, double back_mm, double turn_deg, double leg_mm);
  bool hopeless(const DemoView& view) const;
  double either_way(double degrees);

  static constexpr std::uint64_t kSeed = 0x646f636b;

  bool active_ = false;
  BaseBelief belief_{};
  Evasion evasion_{};
  Random random_{kSeed};
  rt::Duration started_at_{0};
  bool in_beam_ = false;      // of a virtual wall, at the last tick
  std::uint32_t misled_ = 0;  // attempts that failed although it knew the base
  std::uint32_t met_ = 0;     // obstacles, in this attempt

  FloorMemory::Place here_{};
  double way_mm_ = 0.0;
  double last_turned_deg_ = 0.0;

  oi::HomeBaseBeams buoys_{};        // seen now
  oi::HomeBaseBeams last_colour_{};  // seen alone last
  double buoys_since_mm_ = 0.0;      // how far it had come when that changed
  double buoys_since_deg_ = 0.0;
  double seen_mm_ = 0.0;  // the same when it saw anything last
  // The middle of the places where it saw the force field alone, and a buoy.
  MeanPlace field_{};
  MeanPlace lit_{};
  std::array<Edge, 2> edges_{};          // of red's light, of green's
  bool circles_ = false;                 // has just left the middle, and turns back into it
  std::optional<double> heading_deg_{};  // to the base, as `turned_deg` counts; if known
  Edge line_{};                          // a place from where that heading leads to the base
  Leg plan_{};                           // to the way in, or where it looks for it
  Straight straight_{};
  bool pivots_ = false;  // to where it plans to go
};

}  // namespace cargobay::hal::sim
