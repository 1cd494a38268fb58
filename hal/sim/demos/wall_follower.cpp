#include "hal/sim/demos/wall_follower.hpp"

#include <algorithm>

namespace cargobay::hal::sim {

namespace {

constexpr double kFollowMmPerSec = 250.0;
constexpr double kWantedSignal = 2500.0;  // packet 27; some 25 mm from the wall
constexpr double kPartPerSignal = 0.00035;
constexpr double kMostPart = 0.5;
constexpr double kPastCornerMm = 50.0;  // the sensor is ahead of the wheels
constexpr double kAroundCornerMm = 230.0;
// On a narrower arc the wheel passes inside of the cliff sensor that is ahead of it.
constexpr double kAroundCliffMm = 450.0;
constexpr double kAroundBeamMm = 800.0;  // along its edge, in few long bites
constexpr double kWallLostDeg = 400.0;
constexpr double kReleaseMm = 10.0;
constexpr double kFollowBackMm = 60.0;
constexpr double kBeamApartMm = 250.0;

}  // namespace

void WallFollower::start(const DemoView& view) {
  lost_ = false;
  met_beam_mm_ = view.travelled_mm;
  in_beam_ = view.seen->virtual_wall;
  meet(view);
}

void WallFollower::meet(const DemoView& view) {
  const Inputs& seen = *view.seen;
  around_mm_ = seen.any_cliff() ? kAroundCliffMm : bumped(seen) ? kAroundCornerMm : kAroundBeamMm;
  if (seen.any_cliff() || !bumped(seen)) {
    evasion_.start(view, kFollowBackMm, 45.0);
  } else {
    // What is ahead wants more of a turn than what is at the right.
    evasion_.start(view, kReleaseMm, !seen.bump_left ? 20.0 : seen.bump_right ? 60.0 : 90.0);
  }
}

WheelSpeeds WallFollower::step(const DemoView& view) {
  const Inputs& seen = *view.seen;
  WheelSpeeds wheels{};
  const bool enters_beam = seen.virtual_wall && !in_beam_;
  in_beam_ = seen.virtual_wall;
  if (evasion_.active()) {
    if (evasion_.step(view, wheels)) return wheels;
    left_wall_mm_ = view.travelled_mm - kPastCornerMm;
    left_wall_deg_ = view.turned_deg;
  }
  // Within a beam it sees no direction: a step at a time.
  const bool beam = enters_beam || (in_beam_ && view.travelled_mm - met_beam_mm_ >= kBeamApartMm);
  if (beam) met_beam_mm_ = view.travelled_mm;
  if (bumped(seen) || seen.any_cliff() || beam) {
    meet(view);
    (void)evasion_.step(view, wheels);  // it has only begun
    return wheels;
  }
  if (seen.wall_signal > 0) {
    left_wall_mm_ = view.travelled_mm;
    left_wall_deg_ = view.turned_deg;
    const double part =
        std::clamp(kPartPerSignal * (seen.wall_signal - kWantedSignal), -kMostPart, kMostPart);
    return {kFollowMmPerSec * (1.0 - part), kFollowMmPerSec * (1.0 + part)};
  }
  lost_ = left_wall_deg_ - view.turned_deg > kWallLostDeg;
  if (view.travelled_mm - left_wall_mm_ < kPastCornerMm) return straight(kFollowMmPerSec);
  return arc(kFollowMmPerSec, -around_mm_);
}

}  // namespace cargobay::hal::sim
