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
#include "hal/sim/random.hpp"

namespace cargobay::hal::sim {

class Docking {
 public:
  // A demo begins: it has seen nothing.
  void reset(const DemoView& view);
  // At each tick, docking or not: where it is, and what it sees there.
  void watch(const DemoView& view);
  // Where it sees something of a base.
  void start(const DemoView& view);
  bool active() const { return active_; }
  // Not active any longer if it gave up.
  WheelSpeeds step(const DemoView& view);

 private:
  // Where the light of one buoy ends, in the light of the other.
  struct Edge {
    bool known = false;
    double x_mm = 0.0;
    double y_mm = 0.0;
  };

  // The middle of the places where it saw something.
  struct Middle {
    double count = 0.0;
    double x_mm = 0.0;
    double y_mm = 0.0;

    void add(double x, double y) {
      count += 1.0;
      x_mm += (x - x_mm) / count;
      y_mm += (y - y_mm) / count;
    }
  };

  void reckon(const DemoView& view);
  void look(const DemoView& view);
  void cross(oi::HomeBaseBeams from, oi::HomeBaseBeams to);
  void forget();
  double beside_line_mm() const;
  bool take_way_in(const DemoView& view, const BaseBelief::Place& base);
  WheelSpeeds to_way_in(const DemoView& view, const BaseBelief::Place& base);
  WheelSpeeds approach(const DemoView& view);
  WheelSpeeds circle(const DemoView& view);
  WheelSpeeds leg(const DemoView& view);
  WheelSpeeds go_back(const DemoView& view);
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
  std::uint32_t met_ = 0;  // obstacles, in this attempt

  // Its own reckoning: where it is, in a frame of its own, and how far it has come on all its ways.
  double x_mm_ = 0.0;
  double y_mm_ = 0.0;
  double way_mm_ = 0.0;
  double last_travelled_mm_ = 0.0;
  double last_turned_deg_ = 0.0;

  oi::HomeBaseBeams buoys_{};        // seen now
  oi::HomeBaseBeams last_colour_{};  // seen alone last
  double buoys_since_mm_ = 0.0;      // how far it had come when that changed
  double buoys_since_deg_ = 0.0;
  double back_mm_ = 0.0;  // the same when it will be back in the light
  double seen_mm_ = 0.0;  // the same when it saw anything last
  Middle field_{};
  Middle lit_{};                         // by a buoy
  std::array<Edge, 2> edges_{};          // of red's light, of green's
  bool circles_ = false;                 // has just left the middle, and turns back into it
  std::optional<double> heading_deg_{};  // to the base, as `turned_deg` counts; if known
  Edge line_{};                          // a place from where that heading leads to the base
  double leg_end_mm_ = 0.0;  // until it has come so far it drives straight, whatever it sees
  double leg_deg_ = 0.0;
};

}  // namespace cargobay::hal::sim
