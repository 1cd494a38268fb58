#include <algorithm>
#include <chrono>
#include <cmath>

#include "hal/sim/demos/demo_view.hpp"

namespace cargobay::hal::sim {

namespace {

// Where it saw a cliff, so that it stops in time if it turns to one.
constexpr double kCliffTurnMmPerSec = 100.0;
constexpr double kCarefulMm = 500.0;
// Fast, or a robot that comes to a cliff is over it with its caster before it stands.
constexpr double kEvadeBackMmPerSec = 400.0;
constexpr double kFromCliffMm = 80.0;
constexpr double kLeastBackMm = 20.0;
constexpr rt::Duration kStandsFor = std::chrono::milliseconds{45};
constexpr double kStandsMm = 1.0;  // and does not move by more in that time
constexpr double kStandsDeg = 0.5;

}  // namespace

void Evasion::start(const DemoView& view, double back_mm, double turn_deg) {
  if (view.seen->any_cliff()) cliff_mm_ = view.travelled_mm;
  // Not beyond where it began to drive this way: nothing at its back sees a cliff.
  back_mm_ = std::min(back_mm, way_back_mm(view));
  backs_ = back_mm_ > 0.0;
  brake(view);
  turn_deg_ = turn_deg;
  other_way_ = false;
  undoes_ = false;
  began_turned_deg_ = view.turned_deg;
  // At once, or the caster is over the cliff before the robot stands.
  if (backs_ && view.seen->any_cliff()) begin_back(view);
}

void Evasion::begin_back(const DemoView& view) {
  backs_ = false;
  phase_ = Phase::back;
  began_travelled_mm_ = view.travelled_mm;
}

// The encoders cannot see which way a wheel coasts: it stands before it turns the other way.
bool Evasion::stands(const DemoView& view) {
  if (std::abs(view.travelled_mm - stood_mm_) > kStandsMm ||
      std::abs(view.turned_deg - stood_deg_) > kStandsDeg) {
    stands_since_ = view.now;
    stood_mm_ = view.travelled_mm;
    stood_deg_ = view.turned_deg;
  }
  return view.now - stands_since_ >= kStandsFor;
}

void Evasion::brake(const DemoView& view) {
  phase_ = Phase::brake;
  stands_since_ = view.now;
  stood_mm_ = view.travelled_mm;
  stood_deg_ = view.turned_deg;
}

// On the side that it turns to.
bool Evasion::cliff_ahead(const Inputs& seen) const {
  return turn_deg_ > 0.0 ? seen.cliff_left.cliff || seen.cliff_front_left.cliff
                         : seen.cliff_right.cliff || seen.cliff_front_right.cliff;
}

// From a cliff, the way that it came.
void Evasion::retreat(const DemoView& view) {
  back_mm_ = std::min(kFromCliffMm, way_back_mm(view));
  begin_back(view);
}

void Evasion::begin_turn(const DemoView& view) {
  // So close to a cliff a wheel would drop.
  if (view.seen->any_cliff() && !other_way_ && way_back_mm(view) > kLeastBackMm) {
    retreat(view);
    return;
  }
  if (!other_way_) from_deg_ = view.turned_deg;
  phase_ = Phase::turn;
  began_turned_deg_ = view.turned_deg;
  at_cliff_ = cliff_ahead(*view.seen);
}

void Evasion::turn(const DemoView& view) {
  const double turned_deg = view.turned_deg - began_turned_deg_;
  const bool at_cliff = cliff_ahead(*view.seen);
  const bool meets_cliff = at_cliff && !at_cliff_;
  at_cliff_ = at_cliff;
  if (meets_cliff && !undoes_) {
    // The other way round to the same heading; with a cliff there too, back to where it began.
    undoes_ = other_way_;
    other_way_ = true;
    turn_deg_ = undoes_ ? from_deg_ - view.turned_deg
                        : turn_deg_ - turned_deg - std::copysign(360.0, turn_deg_);
    brake(view);
    return;
  }
  if (std::abs(turned_deg) < std::abs(turn_deg_)) return;
  if (undoes_) {
    undoes_ = false;
    turn_deg_ = 0.0;
    retreat(view);
    return;
  }
  brake(view);
  phase_ = Phase::rest;
}

bool Evasion::step(const DemoView& view, WheelSpeeds& wheels) {
  if (view.seen->any_cliff()) cliff_mm_ = view.travelled_mm;
  if (phase_ == Phase::back && began_travelled_mm_ - view.travelled_mm >= back_mm_) brake(view);
  if (phase_ == Phase::brake && stands(view)) {
    if (backs_) {
      begin_back(view);
    } else {
      begin_turn(view);
    }
  }
  if (phase_ == Phase::turn) turn(view);
  if (phase_ == Phase::rest && stands(view)) {
    phase_ = Phase::over;
    turned_at_mm_ = view.travelled_mm;
  }
  const bool careful = std::abs(view.travelled_mm - cliff_mm_) < kCarefulMm;
  switch (phase_) {
    case Phase::over: return false;
    case Phase::rest:
    case Phase::brake: wheels = {}; return true;
    case Phase::back: wheels = straight(-kEvadeBackMmPerSec); return true;
    case Phase::turn:
      wheels = turn_left(std::copysign(careful ? kCliffTurnMmPerSec : turn_mm_s_, turn_deg_));
      return true;
  }
  return false;
}

}  // namespace cargobay::hal::sim
