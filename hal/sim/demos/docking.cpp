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
constexpr double kNearestMm = 200.0;
constexpr double kMiddleHalf = 0.087;  // of the way to the lamps: half as wide is the middle
constexpr double kRetreatMm = 350.0;
constexpr double kLeastRetreatMm = 60.0;
constexpr double kOffMm = 500.0;       // beside the middle for so long: its heading was wrong
constexpr double kShadowMm = 400.0;    // it drives on through a shadow for so long
constexpr double kCircleMm = 180.0;    // the radius it comes back to an edge with
constexpr double kMiddleMm = 350.0;    // the same where it sees both
constexpr double kCircledDeg = 330.0;  // after which it tries elsewhere
constexpr double kUnseenMm = 3000.0;   // it gives up after so long a way without a signal
constexpr double kTouchesMm = 320.0;   // from the lamps, if it is the base that it touches
constexpr std::uint32_t kMetOnWayIn = 8;
constexpr double kKnownUnseenMm = 8000.0;
constexpr std::uint32_t kMostMisled = 2;
constexpr std::uint32_t kMostMetDocking = 12;
constexpr double kInFrontMm = 600.0;  // where it turns into the way in
constexpr double kLegMm = 2000.0;     // radius: nearly straight
constexpr double kLongLegMm = 1500.0;
constexpr rt::Duration kExploresFor = std::chrono::seconds{4};
constexpr std::array<double, 5> kInFrontTriedMm{600.0, 500.0, 400.0, 300.0, 250.0};
constexpr double kAtPlaceMm = 60.0;
constexpr rt::Duration kPlansEvery = std::chrono::milliseconds{600};
constexpr double kTooNearMm = 250.0;  // no room to get to the way in
constexpr rt::Duration kLongest = std::chrono::seconds{90};
constexpr rt::Duration kLongestUnknown = std::chrono::seconds{60};

bool in_field(const Inputs& seen) { return seen.beams().has(oi::HomeBaseBeam::force_field); }

}  // namespace

void Docking::reset(const DemoView& view) {
  active_ = false;
  belief_.forget();
  misled_ = 0;
  last_turned_deg_ = view.turned_deg;
}

void Docking::watch(const DemoView& view, const FloorMemory& floor) {
  here_ = floor.here();
  way_mm_ = floor.way_mm();
  last_turned_deg_ = view.turned_deg;
  belief_.see(here_.x_mm, here_.y_mm, view.seen->beams());
}

void Docking::start(const DemoView& view) {
  active_ = true;
  evasion_.stop();
  started_at_ = view.now;
  met_ = 0;
  buoys_ = {};
  last_colour_ = {};
  seen_mm_ = way_mm_;
  straight_.end_mm = way_mm_;
  field_ = {};
  lit_ = {};
  forget();
  plan_.chosen_at = rt::Duration{0};
}

void Docking::forget() {
  edges_ = {};
  circles_ = false;
  heading_deg_.reset();
}

double Docking::either_way(double degrees) { return random_.uniform() < 0.5 ? degrees : -degrees; }

void Docking::look(const DemoView& view) {
  const oi::HomeBaseBeams seen = view.seen->beams();
  if (seen.any()) seen_mm_ = way_mm_;
  const oi::HomeBaseBeams buoys = seen & kBothBuoys;
  if (seen.any()) (buoys.any() ? lit_ : field_).add(here_);
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
  straight_.end_mm = way_mm_;
  circles_ = from == kBothBuoys;
  // Green's light ends on the red side of the middle.
  const oi::HomeBaseBeams alone = from == kBothBuoys ? to : from;
  Edge& edge = edges_[alone == kRedBuoy ? 0 : 1];
  if (!edge.known) {
    edge = {.known = true, .x_mm = here_.x_mm, .y_mm = here_.y_mm};
    return;
  }
  const double along_x_mm = here_.x_mm - edge.x_mm;
  const double along_y_mm = here_.y_mm - edge.y_mm;
  if (std::hypot(along_x_mm, along_y_mm) < kBaselineMm) return;
  double direction_deg = std::atan2(along_y_mm, along_x_mm) * 180.0 / std::numbers::pi;
  // Toward the base red is on the right: what leads out of it leads to the left.
  const bool leftward = (alone == kRedBuoy) == (to == kBothBuoys);
  const double across = std::sin(radians(last_turned_deg_ - direction_deg));
  if ((across > 0.0) != leftward) direction_deg += 180.0;
  heading_deg_ = last_turned_deg_ + std::remainder(direction_deg - last_turned_deg_, 360.0);
  line_ = {.known = true, .x_mm = here_.x_mm, .y_mm = here_.y_mm};
}

bool Docking::hopeless(const DemoView& view) const {
  const bool known = heading_deg_ || knows_base();
  const rt::Duration longest = known ? kLongest : kLongestUnknown;
  const double unseen_mm = known ? kKnownUnseenMm : kUnseenMm;
  return way_mm_ - seen_mm_ > unseen_mm || met_ > kMostMetDocking ||
         view.now - started_at_ > longest;
}

WheelSpeeds Docking::step(const DemoView& view, FloorMemory& floor) {
  look(view);
  if (hopeless(view)) {
    active_ = false;
    // What it remembers led nowhere more than once.
    if (knows_base() && ++misled_ >= kMostMisled) {
      misled_ = 0;
      belief_.forget();
    }
    return {};
  }
  const Inputs& seen = *view.seen;
  const bool in_beam = seen.virtual_wall && !in_field(seen);
  const bool enters_beam = in_beam && !in_beam_;
  in_beam_ = in_beam;
  const bool evading = evasion_.active();
  WheelSpeeds wheels{};
  if (evading && evasion_.step(view, wheels)) return wheels;
  if (evading) {
    straight_.deg = view.turned_deg;
    straight_.end_mm = way_mm_ + straight_.mm;
    if (pivots_) plan_.chosen_at = view.now;
  }
  if (bumped(seen) || seen.any_cliff() || enters_beam) return meet(view);
  if (way_mm_ < straight_.end_mm) return leg(view);
  if (!heading_deg_) {
    const auto base = belief_.estimate();
    if (base && !take_way_in(view, floor, *base)) return to_way_in(view, floor, *base);
  }
  return heading_deg_ ? approach(view, floor) : circle(view, floor);
}

// From here it can steer onto the way in before it is at the base.
bool Docking::take_way_in(const DemoView& view, const FloorMemory& floor,
                          const BaseBelief::Place& base) {
  const double x_mm = here_.x_mm - base.x_mm;
  const double y_mm = here_.y_mm - base.y_mm;
  const double c = std::cos(base.heading_rad);
  const double s = std::sin(base.heading_rad);
  const double ahead_mm = c * x_mm + s * y_mm;
  const double aside_mm = std::abs(c * y_mm - s * x_mm);
  if (aside_mm > std::max(0.5 * (ahead_mm - kTooNearMm), kAtPlaceMm)) return false;
  // If obstacles leave no way, some are not where it thinks.
  if (met_ < kMetOnWayIn && !floor.open_line(floor.here(), in_front(base, kTooNearMm)))
    return false;
  const double in_deg = (base.heading_rad / std::numbers::pi + 1.0) * 180.0;
  heading_deg_ = view.turned_deg + std::remainder(in_deg - view.turned_deg, 360.0);
  line_ = {.known = true, .x_mm = base.x_mm, .y_mm = base.y_mm};
  buoys_since_mm_ = way_mm_;
  return true;
}

WheelSpeeds Docking::to_way_in(const DemoView& view, FloorMemory& floor,
                               const BaseBelief::Place& base) {
  if (view.now - plan_.chosen_at >= kPlansEvery) {
    plan_.chosen_at = view.now;
    bool open = false;
    for (const double away_mm : kInFrontTriedMm) {
      const FloorMemory::Place place = in_front(base, away_mm);
      if (met_ < kMetOnWayIn && !floor.open_line(place, in_front(base, kTooNearMm))) continue;
      const auto leg = floor.toward(place);
      if (!leg) continue;
      plan_.to = *leg;
      open = true;
      break;
    }
    if (!open) {
      met_ = std::max(met_, kMetOnWayIn);
      plan_.to = in_front(base, kInFrontMm);
    }
  }
  if (at(plan_.to)) plan_.chosen_at = rt::Duration{0};
  return head_for(view, plan_.to);
}

WheelSpeeds Docking::evade(const DemoView& view, double back_mm, double turn_deg, double leg_mm) {
  WheelSpeeds wheels{};
  straight_.mm = leg_mm;
  pivots_ = false;
  evasion_.start(view, back_mm, turn_deg);
  (void)evasion_.step(view, wheels);  // it has only begun
  return wheels;
}

WheelSpeeds Docking::meet(const DemoView& view) {
  const Inputs& seen = *view.seen;
  ++met_;
  // At the base, and missed it by little: back the way it came, and once more.
  const bool near = in_field(seen) && !seen.any_cliff();
  const bool at_base = ahead_mm(view) < kTouchesMm;
  if (heading_deg_ && near && buoys_.any() && at_base && met_ % 3 != 0)
    return evade(view, 300.0, 0.0, 0.0);
  if (heading_deg_ && !at_base) {
    heading_deg_.reset();
    plan_.chosen_at = rt::Duration{0};
    return evade(view, 150.0, 0.0, 0.0);
  }
  if (!heading_deg_ && met_ % 4 != 0) {
    plan_.chosen_at = rt::Duration{0};
    buoys_since_mm_ = way_mm_ - kLongLegMm;
    return evade(view, 80.0, 0.0, 0.0);
  }
  heading_deg_.reset();
  circles_ = false;
  // The base stands at a wall: near it, this leads away from both, and far enough for another try.
  const double most_deg = near ? 170.0 : 150.0;
  const double turn_deg = most_deg - (near ? 60.0 : 110.0) * random_.uniform();
  const double leg_mm = near ? 700.0 : 200.0 + 500.0 * random_.uniform();
  const bool to_the_right = bumped_both(seen) ? random_.uniform() < 0.5 : met_on_the_left(seen);
  return evade(view, 80.0, to_the_right ? -turn_deg : turn_deg, leg_mm);
}

WheelSpeeds Docking::leg(const DemoView& view) const {
  if (buoys_ == kRedBuoy) return arc(kFarMmPerSec, kLegMm);
  if (buoys_ == kGreenBuoy) return arc(kFarMmPerSec, -kLegMm);
  return steer(kFarMmPerSec, straight_.deg - view.turned_deg);
}

// To the way in of a base that all it saw agrees with, where it has not been yet; or else around
// where it saw the light.
std::optional<FloorMemory::Place> Docking::promising(FloorMemory& floor) {
  constexpr int kPlaceTries = 20;
  for (int i = 0; i < kPlaceTries; ++i) {
    const FloorMemory::Place place = in_front(belief_.any(), kInFrontMm);
    if (!floor.is_fresh(place, FloorMemory::Fresh::near)) continue;
    if (const auto leg = floor.toward(place)) return leg;
  }
  const MeanPlace& middle = lit_.count > 0.0 ? lit_ : field_;
  return floor.toward_fresh_around(FloorMemory::Fresh::near, middle.at);
}

WheelSpeeds Docking::explore(const DemoView& view, FloorMemory& floor) {
  if (view.now - plan_.chosen_at >= kExploresFor || at(plan_.to)) {
    plan_.chosen_at = view.now;
    const auto to = promising(floor);
    if (!to) {
      active_ = false;
      return {};
    }
    plan_.to = *to;
  }
  return head_for(view, plan_.to);
}

FloorMemory::Place Docking::in_front(const BaseBelief::Place& base, double away_mm) {
  return {.x_mm = base.x_mm + away_mm * std::cos(base.heading_rad),
          .y_mm = base.y_mm + away_mm * std::sin(base.heading_rad)};
}

bool Docking::at(FloorMemory::Place place) const {
  return std::hypot(place.x_mm - here_.x_mm, place.y_mm - here_.y_mm) < kAtPlaceMm;
}

WheelSpeeds Docking::head_for(const DemoView& view, FloorMemory::Place place) {
  const double way_deg =
      std::atan2(place.y_mm - here_.y_mm, place.x_mm - here_.x_mm) * 180.0 / std::numbers::pi;
  const double left_deg = std::remainder(way_deg - view.turned_deg, 360.0);
  if (std::abs(left_deg) <= kPivotDeg) return steer(kFarMmPerSec, left_deg);
  const WheelSpeeds wheels = evade(view, 0.0, left_deg, 0.0);
  pivots_ = true;
  return wheels;
}

// To the left of it; to the right less than 0.
double Docking::beside_line_mm() const {
  const double heading_rad = radians(*heading_deg_);
  return std::cos(heading_rad) * (here_.y_mm - line_.y_mm) -
         std::sin(heading_rad) * (here_.x_mm - line_.x_mm);
}

// How far it is to the lamps, as far as it knows.
double Docking::ahead_mm(const DemoView& view) const {
  const double most_mm = in_field(*view.seen) ? kBaseFieldMm : kBaseLitMm;
  const auto base = belief_.estimate();
  if (!base) return 0.5 * most_mm;
  return std::clamp(std::hypot(here_.x_mm - base->x_mm, here_.y_mm - base->y_mm), kNearestMm,
                    most_mm);
}

// The middle is where both buoys are seen, and where only one is, it is to the side of the other:
// moves the line there by what it sees.
void Docking::correct_line(double away_mm) {
  const double half_mm = kMiddleHalf * away_mm;
  const double beside_mm = beside_line_mm();
  // Toward the base red is on the right.
  const double least_mm = buoys_ == kGreenBuoy ? half_mm : buoys_ == kBothBuoys ? -half_mm : -1e9;
  const double most_mm = buoys_ == kRedBuoy ? -half_mm : buoys_ == kBothBuoys ? half_mm : 1e9;
  const double by_mm = beside_mm - std::clamp(beside_mm, least_mm, most_mm);
  const double heading_rad = radians(*heading_deg_);
  line_.x_mm -= by_mm * std::sin(heading_rad);
  line_.y_mm += by_mm * std::cos(heading_rad);
}

// Along the middle. So near that it cannot get back to it in time, it backs off first.
WheelSpeeds Docking::approach(const DemoView& view, FloorMemory& floor) {
  const bool off =
      buoys_ != kBothBuoys && way_mm_ - buoys_since_mm_ > (!buoys_.any() ? kShadowMm : kOffMm);
  if (off) {
    forget();
    return circle(view, floor);
  }
  const double away_mm = ahead_mm(view);
  correct_line(away_mm);
  const double beside_mm = beside_line_mm();
  const bool near = in_field(*view.seen);
  if (near && buoys_ != kBothBuoys && std::abs(beside_mm) > kBesideMm &&
      std::abs(beside_mm) > 0.6 * (away_mm - kTooNearMm)) {
    const double left_deg = *heading_deg_ - view.turned_deg;
    if (std::abs(left_deg) > kPivotDeg) return evade(view, 0.0, left_deg, 0.0);
    if (evasion_.way_back_mm(view) > kLeastRetreatMm) return evade(view, kRetreatMm, 0.0, 0.0);
    forget();
    plan_.chosen_at = rt::Duration{0};
    return circle(view, floor);
  }
  const double inward_deg =
      std::clamp(-kInwardDegPerMm * beside_mm, -kMostInwardDeg, kMostInwardDeg);
  const double left_deg = *heading_deg_ + inward_deg - view.turned_deg;
  if (std::abs(left_deg) > kPivotDeg) return evade(view, 0.0, left_deg, 0.0);
  return steer(near ? kNearMmPerSec : kFarMmPerSec, left_deg);
}

// Red is to the right of the way in, so what comes in turns left in it; the wrong way round it
// comes back to the same edge on a circle.
WheelSpeeds Docking::circle(const DemoView& view, FloorMemory& floor) {
  const double speed_mm_s = in_field(*view.seen) ? kNearMmPerSec : kFarMmPerSec;
  if (buoys_ == kBothBuoys)
    return arc(speed_mm_s, last_colour_ == kRedBuoy ? -kMiddleMm : kMiddleMm);
  const bool circles = circles_ && std::abs(view.turned_deg - buoys_since_deg_) < kCircledDeg;
  if (circles) return arc(speed_mm_s, last_colour_ == kRedBuoy ? kCircleMm : -kCircleMm);
  circles_ = false;
  // Across the light, once for each time that it comes to it.
  if (buoys_.any() && way_mm_ - buoys_since_mm_ < kLongLegMm) {
    plan_.chosen_at = rt::Duration{0};
    straight_.deg = view.turned_deg;
    return leg(view);
  }
  return explore(view, floor);
}

}  // namespace cargobay::hal::sim
