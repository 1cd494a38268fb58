// The Cover demo: straight on until it meets something and away from there at random, now and then
// along the walls, now and then in a spiral (OI p. 8).
#pragma once

#include <cstdint>

#include "hal/sim/demos/demo_view.hpp"
#include "hal/sim/demos/wall_follower.hpp"
#include "hal/sim/random.hpp"

namespace cargobay::hal::sim {

class Cover {
 public:
  void start(const DemoView& view);
  // The same, and along the first wall it meets.
  void start_along_walls(const DemoView& view);
  WheelSpeeds step(const DemoView& view);

 private:
  enum class Way : std::uint8_t { bounce, follow, spiral };

  void begin_leg(const DemoView& view);
  WheelSpeeds meet(const DemoView& view);
  WheelSpeeds follow(const DemoView& view);
  double spiral_radius_mm(const DemoView& view) const;

  static constexpr std::uint64_t kSeed = 0x636f766572;

  Way way_ = Way::bounce;
  Evasion evasion_{};
  WallFollower follower_{};
  Random random_{kSeed};
  bool in_beam_ = false;    // of a virtual wall, at the last tick
  std::uint32_t legs_ = 0;  // since it followed a wall last
  std::uint32_t legs_before_wall_ = 0;
  std::uint32_t spirals_ = 0;
  double leg_mm_ = 0.0;  // where this one began
  double leg_deg_ = 0.0;
  double following_mm_ = 0.0;  // how far it wants to, this time
};

}  // namespace cargobay::hal::sim
