#include "hal/sim/demos/docking.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace cargobay::hal::sim {

namespace {

constexpr double kFarMmPerSec = 230.0;
constexpr double kNearMmPerSec = 100.0;   // in the force field
constexpr double kBaselineMm = 80.0;      // two places on an edge so far apart tell its direction
constexpr double kInwardDegPerMm = 0.25;  // how it steers back to the line
constexpr double kMostInwardDeg = 50.0;
constexpr double kBesideMm = 60.0;  // nearer to the base it is too late to steer back by so much
constexpr double kRetreatMm = 350.0;
constexpr double kPivotDeg = 35.0;     // more than this it turns on the spot
constexpr double kOffMm = 500.0;       // beside the middle for so long: its heading was wrong
constexpr double kShadowMm = 400.0;    // it drives on through a shadow for so long
constexpr double kCircleMm = 180.0;    // the radius it comes back to an edge with
constexpr double kMiddleMm = 350.0;    // the same where it sees both
constexpr double kCircledDeg = 330.0;  // after which it tries elsewhere
constexpr double kLegMm = 2000.0;      // radius: nearly straight
constexpr double kLongLegMm = 2500.0;
constexpr double kAsideDeg = 60.0;    // by so much beside the middle of the light
constexpr double kUnseenMm = 1200.0;  // it gives up after so long a way without a signal
constexpr std::uint32_t kMostMet = 10;
constexpr double kInFrontMm = 600.0;  // where it turns into the way in
constexpr double kTooNearMm = 250.0;  // no room to get to the way in
constexpr rt::Duration kLongest = std::chrono::seconds{90};
constexpr rt::Duration kLongestUnknown = std::chrono::seconds{30};

bool in_field(const Inputs& seen) { return seen.beams().has(oi::HomeBaseBeam::force_field); }

}  // namespace

void Docking::reset(const DemoView& view) {
  active_ = false;
  belief_.forget();
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
}

void Docking::watch(const DemoView& view) {
  reckon(view);
  belief_.see(x_mm_, y_mm_, view.seen->beams());
}

void Docking::start(const DemoView& view) {
  active_ = true;
  evasion_.stop();
  started_at_ = view.now;
  met_ = 0;
  buoys_ = {};
  last_colour_ = {};
  seen_mm_ = way_mm_;
  back_mm_ = way_mm_;
  leg_end_mm_ = way_mm_;
  field_ = {};
  lit_ = {};
  forget();
  // In the force field alone there is no telling where the buoys are.
  if (!(view.seen->beams() & kBothBuoys).any()) {
    leg_deg_ = view.turned_deg;
    leg_end_mm_ = way_mm_ + kShadowMm;
  }
}

void Docking::forget() {
  edges_ = {};
  circles_ = false;
  heading_deg_.reset();
}

double Docking::either_way(double degrees) { return random_.uniform() < 0.5 ? degrees : -degrees; }

void Docking::reckon(const DemoView& view) {
  const double gone_mm = view.travelled_mm - last_travelled_mm_;
  const double heading_rad = radians(0.5 * (view.turned_deg + last_turned_deg_));
  x_mm_ += gone_mm * std::cos(heading_rad);
  y_mm_ += gone_mm * std::sin(heading_rad);
  way_mm_ += std::abs(gone_mm);
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
}

void Docking::look(const DemoView& view) {
  const oi::HomeBaseBeams seen = view.seen->beams();
  if (seen.any()) seen_mm_ = way_mm_;
  const oi::HomeBaseBeams buoys = seen & kBothBuoys;
  if (seen.any()) (buoys.any() ? lit_ : field_).add(x_mm_, y_mm_);
  if (buoys == buoys_) return;
  // Backing off and turning it crosses an edge the other way round.
  if (!evasion_.active()) cross(buoys_, buoys);
  if (buoys == kBothBuoys || buoys_ == kBothBuoys || (buoys.any() && buoys != last_colour_)) {
    buoys_since_deg_ = view.turned_deg;
  }
  buoys_since_mm_ = way_mm_;
  buoys_ = buoys;
  if (buoys == kRedBuoy || buoys == kGreenBuoy) last_colour_ = buoys;
}

void Docking::cross(oi::HomeBaseBeams from, oi::HomeBaseBeams to) {
  const bool at_edge = from.any() && to.any() && (from == kBothBuoys || to == kBothBuoys);
  if (!at_edge) return;
  leg_end_mm_ = way_mm_;
  circles_ = from == kBothBuoys;
  // Green's light ends on the red side of the middle.
  const oi::HomeBaseBeams alone = from == kBothBuoys ? to : from;
  Edge& edge = edges_[alone == kRedBuoy ? 0 : 1];
  if (!edge.known) {
    edge = {.known = true, .x_mm = x_mm_, .y_mm = y_mm_};
    return;
  }
  const double along_x_mm = x_mm_ - edge.x_mm;
  const double along_y_mm = y_mm_ - edge.y_mm;
  if (std::hypot(along_x_mm, along_y_mm) < kBaselineMm) return;
  double direction_deg = std::atan2(along_y_mm, along_x_mm) * 180.0 / std::numbers::pi;
  // Toward the base red is on the right: what leads out of it leads to the left.
  const bool leftward = (alone == kRedBuoy) == (to == kBothBuoys);
  const double across = std::sin(radians(last_turned_deg_ - direction_deg));
  if ((across > 0.0) != leftward) direction_deg += 180.0;
  heading_deg_ = last_turned_deg_ + std::remainder(direction_deg - last_turned_deg_, 360.0);
  line_ = {.known = true, .x_mm = x_mm_, .y_mm = y_mm_};
}

bool Docking::hopeless(const DemoView& view) const {
  const rt::Duration longest = heading_deg_ ? kLongest : kLongestUnknown;
  return way_mm_ - seen_mm_ > kUnseenMm || met_ > kMostMet || view.now - started_at_ > longest;
}

WheelSpeeds Docking::step(const DemoView& view) {
  look(view);
  if (hopeless(view)) {
    active_ = false;
    return {};
  }
  const bool evading = evasion_.active();
  WheelSpeeds wheels{};
  if (evading && evasion_.step(view, wheels)) return wheels;
  if (evading) leg_deg_ = view.turned_deg;
  const Inputs& seen = *view.seen;
  if (bumped(seen) || seen.any_cliff()) return meet(view);
  if (way_mm_ < leg_end_mm_) return leg(view);
  if (!heading_deg_) {
    const auto base = belief_.estimate();
    if (base && !take_way_in(view, *base)) return to_way_in(view, *base);
  }
  return heading_deg_ ? approach(view) : circle(view);
}

// From here it can steer onto the way in before it is at the base.
bool Docking::take_way_in(const DemoView& view, const BaseBelief::Place& base) {
  const double x_mm = x_mm_ - base.x_mm;
  const double y_mm = y_mm_ - base.y_mm;
  const double c = std::cos(base.heading_rad);
  const double s = std::sin(base.heading_rad);
  const double ahead_mm = c * x_mm + s * y_mm;
  const double aside_mm = std::abs(c * y_mm - s * x_mm);
  if (aside_mm > 0.5 * (ahead_mm - kTooNearMm)) return false;
  const double in_deg = (base.heading_rad / std::numbers::pi + 1.0) * 180.0;
  heading_deg_ = view.turned_deg + std::remainder(in_deg - view.turned_deg, 360.0);
  line_ = {.known = true, .x_mm = base.x_mm, .y_mm = base.y_mm};
  buoys_since_mm_ = way_mm_;
  return true;
}

WheelSpeeds Docking::to_way_in(const DemoView& view, const BaseBelief::Place& base) {
  const double x_mm = base.x_mm + kInFrontMm * std::cos(base.heading_rad) - x_mm_;
  const double y_mm = base.y_mm + kInFrontMm * std::sin(base.heading_rad) - y_mm_;
  const double way_deg = std::atan2(y_mm, x_mm) * 180.0 / std::numbers::pi;
  const double left_deg = std::remainder(way_deg - view.turned_deg, 360.0);
  if (std::abs(left_deg) > kPivotDeg) return evade(view, 0.0, left_deg, 0.0);
  return steer(kFarMmPerSec, left_deg);
}

WheelSpeeds Docking::evade(const DemoView& view, double back_mm, double turn_deg, double leg_mm) {
  WheelSpeeds wheels{};
  leg_end_mm_ = way_mm_ + back_mm + leg_mm;
  evasion_.start(view, back_mm, turn_deg);
  (void)evasion_.step(view, wheels);  // it has only begun
  return wheels;
}

WheelSpeeds Docking::meet(const DemoView& view) {
  const Inputs& seen = *view.seen;
  ++met_;
  // At the base, and missed it by little: back the way it came, and once more.
  const bool near = in_field(seen) && !seen.any_cliff();
  if (heading_deg_ && near && buoys_.any() && met_ % 3 != 0) return evade(view, 300.0, 0.0, 0.0);
  heading_deg_.reset();
  circles_ = false;
  // The base stands at a wall: near it, this leads away from both, and far enough for another try.
  const double most_deg = near ? 170.0 : 150.0;
  const double turn_deg = most_deg - (near ? 60.0 : 110.0) * random_.uniform();
  const double leg_mm = near ? 700.0 : 200.0 + 500.0 * random_.uniform();
  const bool to_the_right = bumped_both(seen) ? random_.uniform() < 0.5 : met_on_the_left(seen);
  return evade(view, 80.0, to_the_right ? -turn_deg : turn_deg, leg_mm);
}

// Straight on, or nearly so; where the light ends it turns back into it.
WheelSpeeds Docking::leg(const DemoView& view) {
  constexpr double kOutMm = 60.0;
  if (way_mm_ - std::max(seen_mm_, back_mm_) > kOutMm) return go_back(view);
  if (buoys_ == kRedBuoy) return arc(kFarMmPerSec, kLegMm);
  if (buoys_ == kGreenBuoy) return arc(kFarMmPerSec, -kLegMm);
  return steer(kFarMmPerSec, leg_deg_ - view.turned_deg);
}

// The light of a buoy, and of both of them, has no bays: through the middle of where it was seen
// there is a way across all of it, and sooner or later one across the edges.
WheelSpeeds Docking::go_back(const DemoView& view) {
  const Middle& middle = lit_.count > 0.0 ? lit_ : field_;
  const double x_mm = middle.x_mm - x_mm_;
  const double y_mm = middle.y_mm - y_mm_;
  const double way_deg = std::atan2(y_mm, x_mm) * 180.0 / std::numbers::pi;
  const double aside_deg = kAsideDeg * (2.0 * random_.uniform() - 1.0);
  back_mm_ = way_mm_ + std::hypot(x_mm, y_mm);
  return evade(view, 0.0, std::remainder(way_deg + aside_deg - view.turned_deg, 360.0), kLongLegMm);
}

// To the left of it; to the right less than 0.
double Docking::beside_line_mm() const {
  const double heading_rad = radians(*heading_deg_);
  return std::cos(heading_rad) * (y_mm_ - line_.y_mm) -
         std::sin(heading_rad) * (x_mm_ - line_.x_mm);
}

// Along the edge where it crossed it last. So near that it cannot get back to it in time, it backs
// off first.
WheelSpeeds Docking::approach(const DemoView& view) {
  const bool off =
      buoys_ != kBothBuoys && way_mm_ - buoys_since_mm_ > (!buoys_.any() ? kShadowMm : kOffMm);
  if (off) {
    forget();
    return circle(view);
  }
  const double beside_mm = beside_line_mm();
  const bool near = in_field(*view.seen);
  if (near && buoys_ != kBothBuoys && std::abs(beside_mm) > kBesideMm) {
    const double left_deg = *heading_deg_ - view.turned_deg;
    if (std::abs(left_deg) > kPivotDeg) return evade(view, 0.0, left_deg, 0.0);
    return evade(view, kRetreatMm, 0.0, 0.0);
  }
  const double inward_deg =
      std::clamp(-kInwardDegPerMm * beside_mm, -kMostInwardDeg, kMostInwardDeg);
  const double left_deg = *heading_deg_ + inward_deg - view.turned_deg;
  if (std::abs(left_deg) > kPivotDeg) return evade(view, 0.0, left_deg, 0.0);
  return steer(near ? kNearMmPerSec : kFarMmPerSec, left_deg);
}

// Red is to the right of the way in, so what comes in turns left in it; the wrong way round it
// comes back to the same edge on a circle.
WheelSpeeds Docking::circle(const DemoView& view) {
  const double speed_mm_s = in_field(*view.seen) ? kNearMmPerSec : kFarMmPerSec;
  if (buoys_ == kBothBuoys)
    return arc(speed_mm_s, last_colour_ == kRedBuoy ? -kMiddleMm : kMiddleMm);
  const bool circles = circles_ && std::abs(view.turned_deg - buoys_since_deg_) < kCircledDeg;
  if (circles) return arc(speed_mm_s, last_colour_ == kRedBuoy ? kCircleMm : -kCircleMm);
  circles_ = false;
  if (way_mm_ >= leg_end_mm_) leg_end_mm_ = way_mm_ + kLongLegMm;
  leg_deg_ = view.turned_deg;
  return leg(view);
}

}  // namespace cargobay::hal::sim
