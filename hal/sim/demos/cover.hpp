// The Cover demo: straight on until it meets something and away from there at random, now and then
// along the walls, now and then in a spiral (OI p. 8).
#pragma once

#include <cstdint>

#include "hal/sim/demos/demo_view.hpp"
#include "hal/sim/demos/floor_memory.hpp"
#include "hal/sim/demos/wall_follower.hpp"
#include "hal/sim/random.hpp"

namespace cargobay::hal::sim {

class Cover {
 public:
  void start(const DemoView& view);
  // The same, to the nearest new places first, and not far along walls.
  void start_nearby(const DemoView& view);
  // `floor` is of this tick.
  WheelSpeeds step(const DemoView& view, FloorMemory& floor);

 private:
  enum class Way : std::uint8_t { bounce, seek, follow, spiral };

  void begin_leg(const DemoView& view);
  WheelSpeeds meet(const DemoView& view, const FloorMemory& floor);
  WheelSpeeds follow(const DemoView& view, FloorMemory& floor);
  WheelSpeeds seek(const DemoView& view, FloorMemory& floor);
  bool choose(const DemoView& view, FloorMemory& floor);
  double spiral_radius_mm(const DemoView& view) const;

  static constexpr std::uint64_t kSeed = 0x636f766572;

  Way way_ = Way::bounce;
  Evasion evasion_{};
  WallFollower follower_{};
  Random random_{kSeed};
  bool in_beam_ = false;    // of a virtual wall, at the last tick
  std::uint32_t legs_ = 0;  // since it followed a wall last
  bool spiralled_ = false;  // since then, or since all was new
  double leg_mm_ = 0.0;     // where this one began
  double leg_deg_ = 0.0;
  double following_mm_ = 0.0;    // how far it wants to, this time
  FloorMemory::Place toward_{};  // where it seeks a fresh place
  rt::Duration chosen_at_{0};
  std::uint32_t met_ = 0;  // obstacles, on its way there
  bool nearby_ = false;
  bool everywhere_ = false;  // it has been near every place
};

}  // namespace cargobay::hal::sim
