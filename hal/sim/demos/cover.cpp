#include "hal/sim/demos/cover.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::hal::sim {

namespace {

constexpr double kCoverMmPerSec = 250.0;
constexpr double kBounceBackMm = 60.0;
constexpr double kBounceBeamApartMm = 250.0;
constexpr std::uint32_t kLegsBeforeWall = 2;  // at least, and as many again at random
constexpr double kLapDeg = 400.0;             // all around the room, or around what stands in it
constexpr std::uint32_t kLegsBeforeSpiral = 2;
constexpr double kSpiralAfterMm = 900.0;  // a leg so long is in the open
constexpr double kSpiralFromMm = 150.0;
constexpr double kSpiralMmPerDeg = 0.55;  // 200 mm a turn: a bit more than half a robot
constexpr double kSpiralMostMm = 700.0;
constexpr std::uint32_t kSpiralsAfterWall = 1000;  // none before the first wall
constexpr double kShortestWallMm = 14000.0;
constexpr double kLongerWallMm = 12000.0;  // up to so much more

}  // namespace

void Cover::start(const DemoView& view) {
  way_ = Way::bounce;
  evasion_.stop();
  legs_ = 0;
  legs_before_wall_ = 1;
  spirals_ = kSpiralsAfterWall;
  begin_leg(view);
}

void Cover::start_along_walls(const DemoView& view) {
  start(view);
  legs_before_wall_ = 0;
}

void Cover::begin_leg(const DemoView& view) {
  leg_mm_ = view.travelled_mm;
  leg_deg_ = view.turned_deg;
}

WheelSpeeds Cover::step(const DemoView& view) {
  const Inputs& seen = *view.seen;
  WheelSpeeds wheels{};
  const bool enters_beam = seen.virtual_wall && !in_beam_;
  in_beam_ = seen.virtual_wall;
  if (evasion_.active()) {
    if (evasion_.step(view, wheels)) return wheels;
    begin_leg(view);
  }
  if (way_ == Way::follow) return follow(view);
  const double gone_mm = view.travelled_mm - leg_mm_;
  // In the middle of a beam it cannot do better than to drive on for a while.
  const bool beam = enters_beam || (in_beam_ && gone_mm >= kBounceBeamApartMm);
  if (bumped(seen) || seen.any_cliff() || beam) return meet(view);
  if (way_ == Way::spiral) {
    const double radius_mm = spiral_radius_mm(view);
    if (radius_mm < kSpiralMostMm) return arc(kCoverMmPerSec, radius_mm);
    way_ = Way::bounce;
    begin_leg(view);
  }
  if (gone_mm >= kSpiralAfterMm && legs_ >= kLegsBeforeSpiral * (spirals_ + 1)) {
    ++spirals_;
    way_ = Way::spiral;
    begin_leg(view);
  }
  return steer(kCoverMmPerSec, leg_deg_ - view.turned_deg);
}

double Cover::spiral_radius_mm(const DemoView& view) const {
  return kSpiralFromMm + kSpiralMmPerDeg * std::max(view.turned_deg - leg_deg_, 0.0);
}

WheelSpeeds Cover::meet(const DemoView& view) {
  const Inputs& seen = *view.seen;
  WheelSpeeds wheels{};
  way_ = Way::bounce;
  ++legs_;
  const bool wants_wall = legs_before_wall_ == 0 || (seen.bump_right && legs_ >= legs_before_wall_);
  if (wants_wall && bumped(seen) && !seen.any_cliff()) {
    way_ = Way::follow;
    following_mm_ = kShortestWallMm + kLongerWallMm * random_.uniform();
    begin_leg(view);
    follower_.start(view);
    return follower_.step(view);
  }
  const double turn_deg = 50.0 + 120.0 * random_.uniform();
  const bool both = met_on_the_left(seen) ==
                    (seen.bump_right || seen.cliff_right.cliff || seen.cliff_front_right.cliff);
  const bool to_the_right = both ? random_.uniform() < 0.5 : met_on_the_left(seen);
  evasion_.start(view, kBounceBackMm, to_the_right ? -turn_deg : turn_deg);
  (void)evasion_.step(view, wheels);  // it has only begun
  return wheels;
}

WheelSpeeds Cover::follow(const DemoView& view) {
  const double lap_deg = view.turned_deg - leg_deg_;
  const bool around = std::abs(lap_deg) >= kLapDeg;
  if (follower_.lost() || around || view.travelled_mm - leg_mm_ >= following_mm_) {
    WheelSpeeds wheels{};
    way_ = Way::bounce;
    legs_ = 0;
    spirals_ = 0;
    // To the right it was around furniture: the walls of the room are still to be found.
    legs_before_wall_ = lap_deg <= -kLapDeg ? 1 : kLegsBeforeWall + random_.below(kLegsBeforeWall);
    evasion_.start(view, 0.0, 40.0 + 80.0 * random_.uniform());
    (void)evasion_.step(view, wheels);
    return wheels;
  }
  return follower_.step(view);
}

}  // namespace cargobay::hal::sim
