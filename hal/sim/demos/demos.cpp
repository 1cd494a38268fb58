#include "hal/sim/demos/demos.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "oi/dialect.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kSpeedMmPerSec = 250.0;
constexpr double kYieldMmPerSec = 120.0;
constexpr double kBackOffMm = 60.0;
constexpr rt::Duration kTouchesFor = std::chrono::milliseconds{500};
constexpr rt::Duration kLeavesBaseAlone = std::chrono::seconds{5};

// Wimp.
constexpr double kPushMm = 5.0;
constexpr double kYieldMm = 500.0;
constexpr rt::Duration kRolls = std::chrono::milliseconds{500};

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
  docks_again_at_ = view.now;
  touches_since_ = view.now;
  gave_up_ = 0;
  turns_ = 0;
  played_ = 0;
  cliff_before_ = false;
  follows_ = false;
  yields_ = false;
  evasion_.stop();
  const bool homes = number_ == oi::DemoNumber::home || number_ == oi::DemoNumber::tag;
  floor_.reset(view, homes ? FloorMemory::Beams::lead : FloorMemory::Beams::close);
  cover_.start(view);
  docking_.reset(view);
  homing_.start(view);
  begin(view);
}

void Demos::begin(const View& view) {
  since_ = view.now;
  since_mm_ = view.travelled_mm;
  since_deg_ = view.turned_deg;
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
  if (!evasion_.active()) {
    if (!bumped(seen) && !seen.any_cliff()) return false;
    // To the side away from the contact; each turn a little different, as if at random.
    ++turns_;
    const double turn_deg = 60.0 + 37.0 * static_cast<double>(turns_ % 4);
    evasion_.start(view, kBackOffMm, met_on_the_left(seen) ? -turn_deg : turn_deg);
  }
  return evasion_.step(view, action.wheels);
}

// "Identical to the Cover demo, with one exception": where it sees a Home Base, it docks (OI p. 8).
Demos::Action Demos::cover(const View& view, bool docks) {
  const Inputs& seen = *view.seen;
  floor_.watch(view);
  // It stands, and has docked if it still touches the base then: it may coast past the contacts.
  const bool touches = seen.home_base || seen.charger;
  if (!touches) touches_since_ = view.now;
  if (touches) return {.over = view.now - touches_since_ >= kTouchesFor};
  if (docks) docking_.watch(view, floor_);
  const bool again = view.now >= docks_again_at_ || (gave_up_ < 3 && sees_both_buoys(seen));
  const bool finds = docks && !docking_.active() && again;
  if (finds && (seen.beams().any() || docking_.knows_base())) docking_.start(view);
  if (!docking_.active()) return {.wheels = cover_.step(view, floor_)};
  const Action action{.wheels = docking_.step(view, floor_)};
  if (!docking_.active()) {
    // From elsewhere it may do better, and walls lead there; longer each time.
    docks_again_at_ = view.now + ++gave_up_ * kLeavesBaseAlone;
    cover_.start_nearby(view);
  }
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
  const double ratio = 0.5 * oi::kCreate.wheel_base_mm / radius_mm;
  action.wheels = {0.6 * kSpeedMmPerSec * (1.0 - ratio), 0.6 * kSpeedMmPerSec * (1.0 + ratio)};
  return action;
}

// Straight to a wall, then along it with the wall on the right.
Demos::Action Demos::mouse(const View& view) {
  const Inputs& seen = *view.seen;
  if (!follows_ && (bumped(seen) || seen.any_cliff() || seen.virtual_wall)) {
    follows_ = true;
    follower_.start(view);
  }
  if (follows_ && follower_.lost()) {
    follows_ = false;
    begin(view);
  }
  if (follows_) return {.wheels = follower_.step(view)};
  return {.wheels = steer(kSpeedMmPerSec, since_deg_ - view.turned_deg)};
}

// A circle to the left, one to the right, and so on.
Demos::Action Demos::figure_eight(const View& view) {
  Action action{};
  if (bumped(*view.seen) || view.seen->any_cliff()) {
    action.over = true;
    return action;
  }
  if (std::abs(view.turned_deg - since_deg_) >= 360.0) {
    ++turns_;
    begin(view);
  }
  const double outer = kSpeedMmPerSec;
  const double inner = 0.4 * kSpeedMmPerSec;
  action.wheels = turns_ % 2 == 0 ? WheelSpeeds{inner, outer} : WheelSpeeds{outer, inner};
  return action;
}

// Stands until it is pushed, which turns its wheels, and then drives on for a while; away from what
// it meets.
Demos::Action Demos::wimp(const View& view) {
  Action action{};
  if (evade(view, action)) {
    yields_ = true;
    begin(view);
    return action;
  }
  const double gone_mm = view.travelled_mm - since_mm_;
  if (yields_) {
    if (gone_mm < kYieldMm) {
      action.wheels = steer(kYieldMmPerSec, since_deg_ - view.turned_deg);
      return action;
    }
    yields_ = false;
    begin(view);
    return action;
  }
  if (view.now - since_ < kRolls) {
    since_mm_ = view.travelled_mm;  // still from its own driving
  } else if (gone_mm > kPushMm) {
    yields_ = true;
    begin(view);
  }
  return action;
}

// Home stops where it meets something (OI p. 8: "the wall or another obstacle"), Tag turns around
// and looks for the next wall. A wall is straight ahead: what Tag meets with one side is something
// else, and it goes past that.
Demos::Action Demos::home(const View& view, bool goes_on) {
  const Inputs& seen = *view.seen;
  floor_.watch(view);
  if (homing_.on_its_way() && (bumped(seen) || seen.any_cliff())) {
    if (!goes_on) return {.over = true};
    homing_.meet(view, floor_);
  }
  return {.wheels = homing_.step(view, floor_)};
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
