#include "hal/sim/demos/cover.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace cargobay::hal::sim {

namespace {

constexpr double kCoverMmPerSec = 250.0;
constexpr double kBounceBackMm = 60.0;
constexpr double kBounceBeamApartMm = 250.0;
constexpr double kSpiralRoomMm = 500.0;  // it begins in the open
constexpr double kSpiralFromMm = 150.0;
constexpr double kSpiralMmPerDeg = 0.55;  // 200 mm a turn: a bit more than half a robot
constexpr double kSpiralMostMm = 700.0;
constexpr double kShortestWallMm = 14000.0;
constexpr double kLongerWallMm = 12000.0;  // up to so much more
constexpr double kNearbyWallMm = 1500.0;
constexpr double kLeastWallMm = 600.0;
constexpr double kJoinsMm = 300.0;  // it has followed the wall so far ahead already
constexpr double kCoverThereMm = 70.0;
constexpr double kBounceMm = 500.0;  // away from what it could not get around
constexpr std::uint32_t kMostMetSeeking = 3;
constexpr rt::Duration kSeeksFor = std::chrono::milliseconds{3000};

}  // namespace

void Cover::start(const DemoView& view) {
  way_ = Way::bounce;
  evasion_.stop();
  legs_ = 0;
  met_ = 0;
  nearby_ = false;
  spiralled_ = false;
  begin_leg(view);
}

void Cover::start_nearby(const DemoView& view) {
  start(view);
  nearby_ = true;
  way_ = Way::seek;
  chosen_at_ = view.now - kSeeksFor;
}

void Cover::begin_leg(const DemoView& view) {
  leg_mm_ = view.travelled_mm;
  leg_deg_ = view.turned_deg;
}

WheelSpeeds Cover::step(const DemoView& view, FloorMemory& floor) {
  const Inputs& seen = *view.seen;
  WheelSpeeds wheels{};
  const bool enters_beam = seen.virtual_wall && !in_beam_;
  in_beam_ = seen.virtual_wall;
  if (evasion_.active()) {
    if (evasion_.step(view, wheels)) return wheels;
    begin_leg(view);
  }
  if (way_ == Way::follow) return follow(view, floor);
  const double gone_mm = view.travelled_mm - leg_mm_;
  // In the middle of a beam it cannot do better than to drive on for a while.
  const bool beam = enters_beam || (in_beam_ && gone_mm >= kBounceBeamApartMm);
  if (bumped(seen) || seen.any_cliff() || beam) return meet(view, floor);
  if (way_ == Way::spiral) {
    const double radius_mm = spiral_radius_mm(view);
    if (radius_mm < kSpiralMostMm) return arc(kCoverMmPerSec, radius_mm);
    way_ = Way::seek;
    begin_leg(view);
  }
  if (way_ == Way::seek) return seek(view, floor);
  if (legs_ > 0 && gone_mm >= kBounceMm) way_ = Way::seek;
  return steer(kCoverMmPerSec, leg_deg_ - view.turned_deg);
}

bool Cover::choose(const DemoView& view, FloorMemory& floor) {
  chosen_at_ = view.now;
  std::optional<FloorMemory::Place> place;
  if (!nearby_) place = floor.toward_fresh(FloorMemory::Fresh::far);
  everywhere_ = !nearby_ && !place;
  if (!place) place = floor.toward_fresh(FloorMemory::Fresh::uncovered);
  if (!place) return false;
  toward_ = *place;
  return true;
}

WheelSpeeds Cover::seek(const DemoView& view, FloorMemory& floor) {
  const double x_mm = toward_.x_mm - floor.here().x_mm;
  const double y_mm = toward_.y_mm - floor.here().y_mm;
  const bool there = std::hypot(x_mm, y_mm) < kCoverThereMm;
  if (there) met_ = 0;
  const bool again = there || floor.is_old() || view.now - chosen_at_ >= kSeeksFor;
  if (again && !choose(view, floor)) {
    floor.forget();
    spiralled_ = false;
    way_ = Way::bounce;
    return {};
  }
  if (everywhere_ && !spiralled_ && floor.roomy(kSpiralRoomMm)) {
    spiralled_ = true;
    way_ = Way::spiral;
    begin_leg(view);
    return arc(kCoverMmPerSec, kSpiralFromMm);
  }
  const double way_deg =
      std::atan2(toward_.y_mm - floor.here().y_mm, toward_.x_mm - floor.here().x_mm) * 180.0 /
      std::numbers::pi;
  const double left_deg = std::remainder(way_deg - view.turned_deg, 360.0);
  WheelSpeeds wheels{};
  if (std::abs(left_deg) > kPivotDeg) {
    evasion_.start(view, 0.0, left_deg);
    (void)evasion_.step(view, wheels);  // it has only begun
    return wheels;
  }
  return steer(kCoverMmPerSec, left_deg);
}

double Cover::spiral_radius_mm(const DemoView& view) const {
  return kSpiralFromMm + kSpiralMmPerDeg * std::max(view.turned_deg - leg_deg_, 0.0);
}

WheelSpeeds Cover::meet(const DemoView& view, const FloorMemory& floor) {
  const Inputs& seen = *view.seen;
  WheelSpeeds wheels{};
  ++legs_;
  ++met_;
  if (bumped(seen) && !seen.any_cliff() && !floor.followed(0.0)) {
    way_ = Way::follow;
    following_mm_ = nearby_ ? kNearbyWallMm : kShortestWallMm + kLongerWallMm * random_.uniform();
    begin_leg(view);
    follower_.start(view);
    return follower_.step(view);
  }
  if (met_ <= kMostMetSeeking) {
    way_ = Way::seek;
    chosen_at_ = view.now - kSeeksFor;
    evasion_.start(view, kBounceBackMm, 0.0);
    (void)evasion_.step(view, wheels);  // it has only begun
    return wheels;
  }
  met_ = 0;
  way_ = Way::bounce;
  const double turn_deg = 50.0 + 120.0 * random_.uniform();
  const bool both = met_on_the_left(seen) ==
                    (seen.bump_right || seen.cliff_right.cliff || seen.cliff_front_right.cliff);
  const bool to_the_right = both ? random_.uniform() < 0.5 : met_on_the_left(seen);
  evasion_.start(view, kBounceBackMm, to_the_right ? -turn_deg : turn_deg);
  (void)evasion_.step(view, wheels);  // it has only begun
  return wheels;
}

WheelSpeeds Cover::follow(const DemoView& view, FloorMemory& floor) {
  const double gone_mm = view.travelled_mm - leg_mm_;
  const bool joins = gone_mm > kLeastWallMm && floor.followed(kJoinsMm);
  if (joins || follower_.lost() || gone_mm >= following_mm_) {
    way_ = Way::seek;
    chosen_at_ = view.now - kSeeksFor;
    legs_ = 0;
    met_ = 0;
    spiralled_ = false;
    begin_leg(view);
    return {};
  }
  floor.follow_here();
  return follower_.step(view);
}

}  // namespace cargobay::hal::sim
