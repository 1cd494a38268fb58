#include "hal/sim/demos.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kSpeedMmPerSec = 250.0;
constexpr double kTurnMmPerSec = 120.0;
constexpr double kBackOffMm = 50.0;
constexpr double kDockingRunMm = 400.0;

constexpr WheelSpeeds straight(double mm_s) { return {mm_s, mm_s}; }
constexpr WheelSpeeds turn_left(double mm_s) { return {-mm_s, mm_s}; }

bool bumped(const Inputs& seen) { return seen.bump_left || seen.bump_right; }
bool sees_home_base(const Inputs& seen) { return seen.infrared >= 242 && seen.infrared <= 254; }

// The ground of the canon and its first voice, a note a cliff.
constexpr std::array<std::uint8_t, 8> kCanon{78, 76, 74, 73, 71, 69, 71, 73};
// Banjo: the notes of the four cliff sensors, left to right, in the three chords.
constexpr std::array<std::uint8_t, 4> kGMajor{55, 59, 62, 67};
constexpr std::array<std::uint8_t, 4> kDMajor7{57, 61, 62, 66};
constexpr std::array<std::uint8_t, 4> kCMajor{55, 60, 64, 67};

}  // namespace

void Demos::start(std::int32_t number, const View& view) {
  running_ = number >= 0 && number <= static_cast<std::int32_t>(oi::DemoNumber::banjo);
  number_ = running_ ? static_cast<oi::DemoNumber>(number) : oi::DemoNumber::abort;
  started_at_ = view.now;
  turns_ = 0;
  played_ = 0;
  cliff_before_ = false;
  enter(Phase::drive, view);
}

void Demos::enter(Phase phase, const View& view) {
  phase_ = phase;
  phase_travelled_mm_ = view.travelled_mm;
  phase_turned_deg_ = view.turned_deg;
}

Demos::Action Demos::step(const View& view) {
  // Lifted, it stops for good.
  if (view.seen->any_wheel_drop()) {
    running_ = false;
    return {.over = true};
  }
  Action action{};
  switch (number_) {
    case oi::DemoNumber::cover: action = cover(view, false); break;
    case oi::DemoNumber::cover_and_dock: action = cover(view, true); break;
    case oi::DemoNumber::spot_cover: action = spot(view); break;
    case oi::DemoNumber::mouse: action = mouse(view); break;
    case oi::DemoNumber::drive_figure_eight: action = figure_eight(view); break;
    case oi::DemoNumber::wimp: action = wimp(view); break;
    case oi::DemoNumber::home: action = home(view, false); break;
    case oi::DemoNumber::tag: action = home(view, true); break;
    case oi::DemoNumber::pachelbel: action = pachelbel(view); break;
    case oi::DemoNumber::banjo: action = banjo(view); break;
    case oi::DemoNumber::abort: action.over = true; break;
  }
  if (action.over) running_ = false;
  return action;
}

bool Demos::evade(const View& view, Action& action) {
  const Inputs& seen = *view.seen;
  if (phase_ == Phase::drive) {
    if (!bumped(seen) && !seen.any_cliff() && !seen.virtual_wall) return false;
    // To the side away from the contact; each turn a little different, as if at random.
    ++turns_;
    back_off_mm_ = kBackOffMm;
    turn_deg_ = 60.0 + 37.0 * static_cast<double>(turns_ % 4);
    const bool on_the_left = seen.bump_left || seen.cliff_left.cliff || seen.cliff_front_left.cliff;
    if (on_the_left) turn_deg_ = -turn_deg_;
    enter(Phase::back_off, view);
  }
  if (phase_ == Phase::back_off) {
    action.wheels = straight(-kTurnMmPerSec);
    if (phase_travelled_mm_ - view.travelled_mm >= back_off_mm_) enter(Phase::turn, view);
    return true;
  }
  if (std::abs(view.turned_deg - phase_turned_deg_) >= std::abs(turn_deg_)) {
    enter(Phase::drive, view);
    return false;
  }
  action.wheels = turn_left(std::copysign(kTurnMmPerSec, turn_deg_));
  return true;
}

Demos::Action Demos::cover(const View& view, bool docks) {
  Action action{};
  if (view.seen->home_base || view.seen->charger) {
    action.over = true;
    return action;
  }
  const std::uint8_t infrared = view.seen->infrared;
  if (docks && sees_home_base(*view.seen) && phase_ == Phase::drive && !bumped(*view.seen)) {
    // Red is to the right of the way in, green to the left. Where it sees both it is in the middle,
    // and already turns the other way than it came, or it would cross from side to side for ever.
    const bool near = (infrared & 0b10U) != 0;
    const double inner = near ? -0.2 : 0.3;
    const bool red = (infrared & 0b1000U) != 0;
    const bool green = (infrared & 0b100U) != 0;
    if (red != green) came_from_red_ = red;
    const bool to_the_left = red != green ? red : !came_from_red_;
    const double left = to_the_left ? inner : 1.0;
    const double right = to_the_left ? 1.0 : inner;
    action.wheels = {left * kTurnMmPerSec, right * kTurnMmPerSec};
    return action;
  }
  const bool missed = docks && sees_home_base(*view.seen) && phase_ == Phase::drive;
  const bool evades = evade(view, action);
  if (missed && phase_ == Phase::back_off) {
    // Straight back, for another try.
    back_off_mm_ = kDockingRunMm;
    turn_deg_ = 0.0;
  }
  if (evades) return action;
  action.wheels = straight(kSpeedMmPerSec);
  return action;
}

// Outward and then inward again; 30 s each.
Demos::Action Demos::spot(const View& view) {
  Action action{};
  const double time_s = rt::seconds(view.now - started_at_);
  if (time_s > 60.0) {
    action.over = true;
    return action;
  }
  if (evade(view, action)) return action;
  const double growth = time_s < 30.0 ? time_s : 60.0 - time_s;
  const double radius_mm = 100.0 + 20.0 * growth;
  const double ratio = 0.5 * oi::kWheelBaseMm / radius_mm;
  action.wheels = {0.6 * kSpeedMmPerSec * (1.0 - ratio), 0.6 * kSpeedMmPerSec * (1.0 + ratio)};
  return action;
}

// Straight to a wall, then along it with the wall on the right.
Demos::Action Demos::mouse(const View& view) {
  Action action{};
  const Inputs& seen = *view.seen;
  if (bumped(seen)) enter(Phase::align, view);
  if (seen.any_cliff() || phase_ == Phase::back_off || phase_ == Phase::turn) {
    if (evade(view, action)) return action;
  }
  if (phase_ == Phase::align) {
    const double turned_deg = view.turned_deg - phase_turned_deg_;
    action.wheels = turned_deg < 20.0 ? turn_left(kTurnMmPerSec)
                    : seen.wall       ? straight(kSpeedMmPerSec)
                                      : WheelSpeeds{kSpeedMmPerSec, 0.7 * kSpeedMmPerSec};
    return action;
  }
  action.wheels = straight(kSpeedMmPerSec);
  return action;
}

// A circle to the left, one to the right, and so on.
Demos::Action Demos::figure_eight(const View& view) {
  Action action{};
  if (bumped(*view.seen) || view.seen->any_cliff()) {
    action.over = true;
    return action;
  }
  if (std::abs(view.turned_deg - phase_turned_deg_) >= 360.0) {
    ++turns_;
    enter(Phase::drive, view);
  }
  const double outer = kSpeedMmPerSec;
  const double inner = 0.4 * kSpeedMmPerSec;
  action.wheels = turns_ % 2 == 0 ? WheelSpeeds{inner, outer} : WheelSpeeds{outer, inner};
  return action;
}

// Waits to be pushed: what moves the wheels moves it on. Backs off from what it meets.
Demos::Action Demos::wimp(const View& view) {
  Action action{};
  if (bumped(*view.seen)) ++turns_;
  if (phase_ != Phase::drive || bumped(*view.seen) || view.seen->any_cliff()) {
    if (evade(view, action)) return action;
  }
  const bool pushed = view.travelled_mm - phase_travelled_mm_ > 5.0;
  if (pushed && view.travelled_mm - phase_travelled_mm_ < 500.0)
    action.wheels = straight(kTurnMmPerSec);
  if (view.travelled_mm - phase_travelled_mm_ >= 500.0) enter(Phase::drive, view);
  return action;
}

// Turns until it sees a virtual wall, drives there, and stops where it meets something; Tag turns
// around and looks for the next.
Demos::Action Demos::home(const View& view, bool goes_on) {
  Action action{};
  if (phase_ == Phase::drive && bumped(*view.seen)) {
    if (!goes_on) {
      action.over = true;
      return action;
    }
    turn_deg_ = 180.0;
    enter(Phase::back_off, view);
  }
  if (phase_ == Phase::back_off || phase_ == Phase::turn) {
    if (phase_ == Phase::back_off) {
      action.wheels = straight(-kTurnMmPerSec);
      if (phase_travelled_mm_ - view.travelled_mm >= kBackOffMm) enter(Phase::turn, view);
      return action;
    }
    if (std::abs(view.turned_deg - phase_turned_deg_) < turn_deg_) {
      action.wheels = turn_left(kTurnMmPerSec);
      return action;
    }
    enter(Phase::drive, view);
  }
  if (view.seen->any_cliff()) return action;
  action.wheels =
      view.seen->virtual_wall ? straight(kSpeedMmPerSec) : turn_left(0.5 * kTurnMmPerSec);
  return action;
}

Demos::Action Demos::pachelbel(const View& view) {
  Action action{};
  const bool cliff = view.seen->any_cliff();
  if (cliff && !cliff_before_) ++played_;
  cliff_before_ = cliff;
  if (cliff) action.note = kCanon[(played_ - 1) % kCanon.size()];
  return action;
}

Demos::Action Demos::banjo(const View& view) const {
  Action action{};
  const Inputs& seen = *view.seen;
  const bool both = seen.bump_left && seen.bump_right;
  const auto& chord = both ? kCMajor : bumped(seen) ? kDMajor7 : kGMajor;
  if (seen.cliff_left.cliff) action.note = chord[0];
  if (seen.cliff_front_left.cliff) action.note = chord[1];
  if (seen.cliff_front_right.cliff) action.note = chord[2];
  if (seen.cliff_right.cliff) action.note = chord[3];
  return action;
}

}  // namespace cargobay::hal::sim
