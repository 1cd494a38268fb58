#include "hal/sim/demos/homing.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "hal/sim/safety.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kHomingMmPerSec = 200.0;
constexpr double kSpinMmPerSec = 140.0;
constexpr double kTagBackMm = 60.0;
constexpr double kAroundDeg = 75.0;  // it goes on turning from there
constexpr double kFullTurnDeg = 380.0;
constexpr double kMostTurnDeg = 800.0;   // to see where a wall comes into sight and where it leaves
constexpr double kMostUnseenMm = 500.0;  // along the edge of a beam it is now and then outside
constexpr double kMiddleEveryMm = 50.0;
constexpr double kOnLineMm = 1500.0;
constexpr double kSameWallMm = 200.0;  // what is so close to its line of sight is the same wall
constexpr double kSeesMm = 2400.0;
constexpr double kBackDegPerMm = 0.25;  // how it steers back to its line
constexpr double kMostBackDeg = 20.0;
constexpr double kHomingThereMm = 70.0;
constexpr std::uint32_t kMostBumps = 3;
constexpr rt::Duration kHomingChoosesEvery = std::chrono::seconds{3};
// From where it met something, along its heading there: behind that, then back the way it came.
constexpr std::array<double, 6> kLooksAtMm{500.0, -400.0, -800.0, 900.0, -1200.0, -1600.0};
constexpr std::size_t kMostPlaces = kLooksAtMm.size() + 8;

FloorMemory::Place beyond(FloorMemory::Place from, double heading_deg, double distance_mm) {
  return {.x_mm = from.x_mm + distance_mm * std::cos(radians(heading_deg)),
          .y_mm = from.y_mm + distance_mm * std::sin(radians(heading_deg))};
}

}  // namespace

void Homing::start(const DemoView& view) {
  evasion_.stop();
  has_met_ = false;
  ever_saw_ = false;
  place_ = kLooksAtMm.size();
  middle_ = {};
  side_ = 1.0;
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
  spin_from_here(view);
}

void Homing::reckon(const DemoView& view, const FloorMemory& floor) {
  const double gone_mm = view.travelled_mm - last_travelled_mm_;
  beside_mm_ += gone_mm * std::sin(radians(0.5 * (view.turned_deg + last_turned_deg_)) -
                                   radians(heading_deg_));
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
  if (view.seen->virtual_wall && floor.way_mm() - counted_mm_ >= kMiddleEveryMm) {
    counted_mm_ = floor.way_mm();
    middle_.add(floor.here());
  }
  if (!view.seen->virtual_wall || phase_ != Phase::drive || evasion_.active()) return;
  ever_saw_ = true;
  saw_ = floor.here();
}

void Homing::met(const FloorMemory& floor) {
  has_met_ = true;
  // On the line that led there.
  met_deg_ = heading_deg_;
  met_ = beyond(floor.here(), heading_deg_ + 90.0, -beside_mm_);
  place_ = 0;
  bumps_ = 0;
  ever_saw_ = false;
  look_mm_ = floor.way_mm();
}

void Homing::meet(const DemoView& view, const FloorMemory& floor) {
  met(floor);
  if (bumped_both(*view.seen)) {
    turn_around(view);
  } else {
    go_past(view);
  }
}

void Homing::turn_around(const DemoView& view) {
  side_ = -side_;
  evasion_.start(view, kTagBackMm, side_ * kAroundDeg);
  spin_from_here(view);
}

void Homing::go_past(const DemoView& view) {
  phase_ = Phase::search;
  chosen_at_ = rt::Duration{0};
  side_ = met_on_the_left(*view.seen) ? 1.0 : -1.0;  // to where it was heading
  evasion_.start(view, kTagBackMm, 0.0);
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
  evasion_.start(view, 0.0, turn_deg);
}

void Homing::drive_on_line(const DemoView& view) {
  drive_toward(view, met_deg_);
  most_unseen_mm_ = kOnLineMm;
}

// Whether what it sees at that heading is what it has bumped into.
bool Homing::is_the_last(const FloorMemory& floor, double heading_deg) const {
  if (!has_met_) return false;
  const FloorMemory::Place wall = beyond(met_, met_deg_, kRobotRadiusMm);
  const double x_mm = wall.x_mm - floor.here().x_mm;
  const double y_mm = wall.y_mm - floor.here().y_mm;
  const double c = std::cos(radians(heading_deg));
  const double s = std::sin(radians(heading_deg));
  const double ahead_mm = c * x_mm + s * y_mm;
  return ahead_mm > 0.0 && ahead_mm < kSeesMm && std::abs(c * y_mm - s * x_mm) < kSameWallMm;
}

WheelSpeeds Homing::step(const DemoView& view, FloorMemory& floor) {
  reckon(view, floor);
  WheelSpeeds wheels{};
  const bool meets = bumped(*view.seen) || view.seen->any_cliff();
  if (meets && phase_ != Phase::drive && !evasion_.active()) {
    ++bumps_;
    chosen_at_ = rt::Duration{0};
    evasion_.start(view, kTagBackMm, 0.0);
  }
  if (evasion_.active()) {
    if (evasion_.step(view, wheels)) return wheels;
    if (phase_ == Phase::spin) spin_from_here(view);
    unseen_mm_ = view.travelled_mm;
    beside_mm_ = 0.0;
  }
  switch (phase_) {
    case Phase::spin: return spin(view, floor);
    case Phase::drive: return drive(view);
    case Phase::search: return search(view, floor);
  }
  return wheels;
}

WheelSpeeds Homing::spin(const DemoView& view, FloorMemory& floor) {
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
    if (is_the_last(floor, heading_deg)) return turn_left(side_ * kSpinMmPerSec);
    has_met_ = false;
    drive_toward(view, heading_deg);
  } else if (sees_ && seen_deg >= kFullTurnDeg && !has_met_) {
    // Without the tape it sees the wall whatever way it turns.
    drive_toward(view, view.turned_deg);
  } else if (turned_deg >= (sees_ ? kMostTurnDeg : kFullTurnDeg)) {
    search_elsewhere(floor);
  }
  return turn_left(side_ * kSpinMmPerSec);
}

FloorMemory::Place Homing::from_met(double ahead_mm) const {
  return beyond(met_, met_deg_, ahead_mm);
}

void Homing::search_elsewhere(const FloorMemory& floor) {
  phase_ = Phase::search;
  look_mm_ = floor.way_mm();
  chosen_at_ = rt::Duration{0};
}

// The way to the next place to look from; false if there is none.
bool Homing::choose(const DemoView& view, FloorMemory& floor) {
  chosen_at_ = view.now;
  if (ever_saw_) {
    const auto leg = floor.toward(saw_, FloorMemory::Care::wide);
    if (leg && bumps_ < kMostBumps) {
      to_ = *leg;
      return true;
    }
    ever_saw_ = false;
  }
  while (has_met_ && place_ < kLooksAtMm.size()) {
    const auto leg = floor.toward(from_met(kLooksAtMm[place_]), FloorMemory::Care::wide);
    if (leg && bumps_ < kMostBumps) {
      to_ = *leg;
      return true;
    }
    ++place_;
    bumps_ = 0;
  }
  bumps_ = 0;
  auto leg =
      floor.toward_fresh_around(FloorMemory::Fresh::near, middle_.at, FloorMemory::Care::wide);
  if (!leg) {
    floor.forget();
    has_met_ = false;  // then the last will do
    leg = floor.toward_fresh_around(FloorMemory::Fresh::near, middle_.at, FloorMemory::Care::wide);
  }
  if (!leg) return false;
  to_ = *leg;
  return true;
}

WheelSpeeds Homing::search(const DemoView& view, FloorMemory& floor) {
  const auto left_mm = [&](FloorMemory::Place place) {
    return std::hypot(place.x_mm - floor.here().x_mm, place.y_mm - floor.here().y_mm);
  };
  const bool listed = has_met_ && place_ < kLooksAtMm.size();
  const bool there = left_mm(to_) < kHomingThereMm;
  const double gone_mm = floor.way_mm() - look_mm_;
  const bool at_place = listed && left_mm(from_met(kLooksAtMm[place_])) < kHomingThereMm;
  const bool at_saw = ever_saw_ && left_mm(saw_) < kHomingThereMm;
  if (at_saw) ever_saw_ = false;
  if (at_place) ++place_;
  // On the far side of what it met it is on the line to the wall again.
  if (at_place && kLooksAtMm[place_ - 1] > 0.0) {
    drive_on_line(view);
    return {};
  }
  if (at_saw || at_place || (!listed && there && gone_mm > 300.0)) {
    spin_from_here(view);
    return spin(view, floor);
  }
  // It comes into a beam that leads elsewhere.
  if (view.seen->virtual_wall && gone_mm > 150.0 && !is_the_last(floor, view.turned_deg)) {
    look_mm_ = floor.way_mm();
    spin_from_here(view);
    return spin(view, floor);
  }
  if ((there || view.now - chosen_at_ >= kHomingChoosesEvery) && !choose(view, floor)) {
    spin_from_here(view);
    return spin(view, floor);
  }
  const double way_deg = std::atan2(to_.y_mm - floor.here().y_mm, to_.x_mm - floor.here().x_mm) *
                         180.0 / std::numbers::pi;
  const double left_deg = std::remainder(way_deg - view.turned_deg, 360.0);
  WheelSpeeds wheels = steer(kHomingMmPerSec, left_deg);
  if (std::abs(left_deg) > kPivotDeg) {
    evasion_.start(view, 0.0, left_deg);
    (void)evasion_.step(view, wheels);  // it has only begun
  }
  return wheels;
}

WheelSpeeds Homing::drive(const DemoView& view) {
  if (view.seen->virtual_wall) unseen_mm_ = view.travelled_mm;
  if (view.travelled_mm - unseen_mm_ < most_unseen_mm_) {
    const double inward_deg = std::clamp(-kBackDegPerMm * beside_mm_, -kMostBackDeg, kMostBackDeg);
    return steer(kHomingMmPerSec, heading_deg_ + inward_deg - view.turned_deg);
  }
  spin_from_here(view);
  return turn_left(side_ * kSpinMmPerSec);
}

}  // namespace cargobay::hal::sim
