#include "hal/sim/demos/homing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cargobay::hal::sim {

namespace {

constexpr double kHomingMmPerSec = 200.0;
constexpr double kSpinMmPerSec = 60.0;
constexpr double kTagBackMm = 60.0;
constexpr double kAroundDeg = 75.0;  // it goes on turning from there
constexpr double kFullTurnDeg = 400.0;
constexpr double kMostTurnDeg = 800.0;  // to see where a wall comes into sight and where it leaves
constexpr double kStepOnMm = 250.0;
constexpr double kIntoBeamMm = 60.0;     // past its edge
constexpr double kMostUnseenMm = 500.0;  // along the edge of a beam it is now and then outside
constexpr double kSameWallDeg = 50.0;    // so near to where it bumped it is the same wall again
constexpr double kBackDegPerMm = 0.25;   // how it steers back to its line
constexpr double kMostBackDeg = 20.0;
constexpr double kTagAsideDeg = 80.0;
constexpr double kPastObstacleDeg = 65.0;
constexpr double kPastObstacleMm = 350.0;

// Around what it met, to behind it: by headings from the one it met it at.
struct Leg {
  double aside_deg = 0.0;
  double long_mm = 0.0;
};
constexpr std::array<Leg, 3> kAroundIt{
    {{kTagAsideDeg, 350.0}, {0.0, 750.0}, {-kTagAsideDeg, 350.0}}};

}  // namespace

void Homing::start(const DemoView& view) {
  evasion_.stop();
  searches_ = false;
  turns_around_ = false;
  legs_ = 0;
  went_past_ = false;
  side_ = 1.0;
  ever_saw_ = false;
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
  spin_from_here(view);
}

void Homing::reckon(const DemoView& view) {
  const double gone_mm = view.travelled_mm - last_travelled_mm_;
  const double heading_rad = radians(0.5 * (view.turned_deg + last_turned_deg_));
  x_mm_ += gone_mm * std::cos(heading_rad);
  beside_mm_ += gone_mm * std::sin(heading_rad - radians(heading_deg_));
  y_mm_ += gone_mm * std::sin(heading_rad);
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
  if (!view.seen->virtual_wall) return;
  ever_saw_ = true;
  x_mm_ = 0.0;
  y_mm_ = 0.0;
}

void Homing::turn_around(const DemoView& view) {
  side_ = -side_;
  turns_around_ = true;
  went_around_ = false;
  went_past_ = false;
  legs_ = 0;
  bumped_deg_ = view.turned_deg;
  evasion_.start(view, kTagBackMm, side_ * kAroundDeg);
  spin_from_here(view);
}

void Homing::go_past(const DemoView& view) {
  // Once more at the same: then it is in its way whatever side it passes.
  if (went_past_ && std::abs(std::remainder(view.turned_deg - past_deg_, 360.0)) < kSameWallDeg) {
    turn_around(view);
    return;
  }
  went_past_ = true;
  past_deg_ = view.turned_deg;
  const bool left = met_on_the_left(*view.seen);
  const double turn_deg = left ? -kPastObstacleDeg : kPastObstacleDeg;
  drive_toward(view, view.turned_deg + turn_deg);
  evasion_.start(view, kTagBackMm, turn_deg);
  most_unseen_mm_ = kPastObstacleMm;
  searches_ = true;
  turns_around_ = false;
  side_ = left ? 1.0 : -1.0;  // to where it was heading
}

void Homing::spin_from_here(const DemoView& view) {
  phase_ = Phase::spin;
  spin_deg_ = view.turned_deg;
  sees_ = view.seen->virtual_wall;
  came_into_sight_ = false;
}

void Homing::drive_toward(const DemoView& view, double heading_deg) {
  phase_ = Phase::drive;
  const double turn_deg = std::remainder(heading_deg - view.turned_deg, 360.0);
  heading_deg_ = view.turned_deg + turn_deg;
  most_unseen_mm_ = kMostUnseenMm;
  searches_ = false;
  found_ = false;
  evasion_.start(view, 0.0, turn_deg);
}

bool Homing::is_the_last(double heading_deg) const {
  return turns_around_ && std::abs(std::remainder(heading_deg - bumped_deg_, 360.0)) < kSameWallDeg;
}

// What it meets where it only looks is no wall.
void Homing::evade(const DemoView& view) {
  const bool left = met_on_the_left(*view.seen);
  evasion_.start(view, kTagBackMm, left ? -kTagAsideDeg : kTagAsideDeg);
  spin_from_here(view);
}

WheelSpeeds Homing::step(const DemoView& view) {
  reckon(view);
  WheelSpeeds wheels{};
  const bool met = bumped(*view.seen) || view.seen->any_cliff();
  if (met && searches_ && !evasion_.active()) {
    searches_ = false;
    if (legs_ > 0) turns_around_ = false;
    legs_ = 0;
    evade(view);
  }
  if (evasion_.active()) {
    if (evasion_.step(view, wheels)) return wheels;
    if (phase_ == Phase::spin) spin_from_here(view);
    unseen_mm_ = view.travelled_mm;
    beside_mm_ = 0.0;
  }
  return phase_ == Phase::spin ? spin(view) : drive(view);
}

WheelSpeeds Homing::spin(const DemoView& view) {
  const bool saw = sees_;
  sees_ = view.seen->virtual_wall;
  if (sees_ && !saw) {
    came_into_sight_ = true;
    came_deg_ = view.turned_deg;
  }
  const double turned_deg = std::abs(view.turned_deg - spin_deg_);
  const double seen_deg = came_into_sight_ ? std::abs(view.turned_deg - came_deg_) : turned_deg;
  if (saw && !sees_ && came_into_sight_) {
    came_into_sight_ = false;
    const double heading_deg = 0.5 * (came_deg_ + view.turned_deg);
    if (is_the_last(heading_deg)) return turn_left(side_ * kSpinMmPerSec);
    turns_around_ = false;
    drive_toward(view, heading_deg);
  } else if (sees_ && seen_deg >= kFullTurnDeg && !turns_around_) {
    // Without the tape it sees the wall whatever way it turns.
    drive_toward(view, view.turned_deg);
  } else if (turned_deg >= (sees_ ? kMostTurnDeg : kFullTurnDeg)) {
    search_elsewhere(view);
  }
  return turn_left(side_ * kSpinMmPerSec);
}

void Homing::next_leg(const DemoView& view) {
  const Leg& leg = kAroundIt[legs_++];
  drive_toward(view, bumped_deg_ + side_ * leg.aside_deg);
  most_unseen_mm_ = leg.long_mm;
  searches_ = true;
}

// Back to where it saw a wall last, or on to elsewhere. The next wall may be beyond the one it
// bumped into.
void Homing::search_elsewhere(const DemoView& view) {
  if (turns_around_ && !went_around_) {
    went_around_ = true;
    next_leg(view);
    return;
  }
  turns_around_ = false;
  const double way_deg =
      ever_saw_ ? std::atan2(-y_mm_, -x_mm_) * 180.0 / std::numbers::pi : view.turned_deg;
  drive_toward(view, way_deg);
  most_unseen_mm_ = ever_saw_ ? std::hypot(x_mm_, y_mm_) + kIntoBeamMm : kStepOnMm;
  searches_ = true;
  ever_saw_ = false;
}

WheelSpeeds Homing::drive(const DemoView& view) {
  if (view.seen->virtual_wall && !searches_) unseen_mm_ = view.travelled_mm;
  const double gone_mm = view.travelled_mm - unseen_mm_;
  // It spins a little farther into the beam.
  if (view.seen->virtual_wall && searches_ && legs_ == 0 && !found_) {
    found_ = true;
    most_unseen_mm_ = gone_mm + kIntoBeamMm;
  }
  if (gone_mm < most_unseen_mm_) {
    const double inward_deg = std::clamp(-kBackDegPerMm * beside_mm_, -kMostBackDeg, kMostBackDeg);
    return steer(kHomingMmPerSec, heading_deg_ + inward_deg - view.turned_deg);
  }
  if (legs_ > 0 && legs_ < kAroundIt.size()) {
    next_leg(view);
    return {};
  }
  if (legs_ > 0) bumped_deg_ += 180.0;  // it has the last one at its back
  legs_ = 0;
  spin_from_here(view);
  return spin(view);
}

}  // namespace cargobay::hal::sim
