#include "rt/course.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cargobay::rt {
namespace {

constexpr double kStandingMmS = 4.0;
constexpr double kComeToCurve = 0.01;  // of the speed, across: the wheels have come to the curve
// Where the robot is aside, it heads back so that a third is left after this way.
constexpr double kBackWithinMm = 1000.0;
constexpr double kMostAsideMm = 6.0;        // as an error of the wheels: 2 degrees
constexpr double kMostRememberedMm = 30.0;  // the same, of what waits to be taken back
constexpr double kSameCurve = 1e-3;         // sine of the angle between two directions
constexpr double kMostCourseMm = 64.0;      // across, both wheels together: 20 degrees
// Of the set speed, for what is taken back.
constexpr double kBackShare = 0.007;
constexpr double kBackLeastMmS = 0.4;
constexpr double kBackShareHolding = 0.08;
constexpr double kBackLeastHoldingMmS = 4.0;
// More of it, in a second, of an error that is larger than what the angle is known to anyway ...
constexpr double kHurry1S = 0.5;
constexpr double kCalmMm = 4.0;
constexpr double kHurryIfLost = 0.3;  // part of that; and the error must be larger
constexpr double kCalmMoreIfLostMm = 1.0;
constexpr double kHurryShare = 0.015;
constexpr double kHurryMmS = 1.5;
// ... as far as each wheel stays so close to its set speed, which is called settled.
constexpr double kSettledShare = 0.03;
constexpr double kSettledMmS = 2.4;

WheelSpeeds less(const WheelSpeeds& a, const WheelSpeeds& b) CARGOBAY_NONBLOCKING {
  return {a.left_mm_s - b.left_mm_s, a.right_mm_s - b.right_mm_s};
}

double length(const WheelSpeeds& a) CARGOBAY_NONBLOCKING {
  return std::sqrt(a.left_mm_s * a.left_mm_s + a.right_mm_s * a.right_mm_s);
}

}  // namespace

void Course::forget() CARGOBAY_NONBLOCKING {
  along_ = {};
  if_carried_mm_ = 0.0;
  if_lost_mm_ = 0.0;
  error_mm_ = 0.0;
  unread_way_mm_ = 0.0;
  aside_mm_ = 0.0;
}

// The same curve at another speed goes on; back along it, the other wheel is ahead. From standing,
// a curve begins at once; from another curve, when the wheels have come to it: what they went in
// between is not off either.
bool Course::follows(const WheelSpeeds& target, const WheelSpeeds& now) CARGOBAY_NONBLOCKING {
  const double speed = length(target);
  if (speed == 0.0) {
    forget();
    return false;
  }
  const WheelSpeeds next{target.left_mm_s / speed, target.right_mm_s / speed};
  const double turned = along_.left_mm_s * next.right_mm_s - along_.right_mm_s * next.left_mm_s;
  const double same = along_.left_mm_s * next.left_mm_s + along_.right_mm_s * next.right_mm_s;
  if (along_ == WheelSpeeds{} || std::abs(turned) > kSameCurve) {
    forget();
    on_curve_ = length(now) < kStandingMmS;
  }
  if (same < 0.0) {
    if_carried_mm_ = -if_carried_mm_;
    if_lost_mm_ = -if_lost_mm_;
    aside_mm_ = -aside_mm_;
  }
  along_ = next;
  if (std::abs(across(now)) < kComeToCurve * speed) on_curve_ = true;
  return on_curve_;
}

double Course::across(const WheelSpeeds& way) const CARGOBAY_NONBLOCKING {
  return along_.left_mm_s * way.right_mm_s - along_.right_mm_s * way.left_mm_s;
}

// The error and, as one of the wheels, what the way went aside for it.
double Course::off_mm() const CARGOBAY_NONBLOCKING {
  return error_mm_ + std::clamp(aside_mm_, -kMostAsideMm, kMostAsideMm);
}

void Course::go_aside(const Ways& ways, double way_mm, double carried) CARGOBAY_NONBLOCKING {
  unread_way_mm_ += way_mm;
  double aside = error_mm_ * way_mm;
  if (ways.corrected_mm != 0.0) {
    const double corrected_mm =
        (along_.left_mm_s + along_.right_mm_s) / 2.0 * ways.corrected_mm * (1.0 - carried);
    aside += corrected_mm * std::exchange(unread_way_mm_, 0.0) / 2.0;
  }
  aside_mm_ = std::clamp(aside_mm_ + aside / kBackWithinMm, -kMostRememberedMm, kMostRememberedMm);
}

double Course::held_back_mm_s(const WheelSpeeds& set) const CARGOBAY_NONBLOCKING {
  const double most = kBackShareHolding * length(set) + kBackLeastHoldingMmS;
  return std::clamp(parameters_.holding_rate_1_s * off_mm(), -most, most);
}

// With which speed that is taken back, across: slowly, and sooner if it is more than what the angle
// is known to anyway.
double Course::back_mm_s(const WheelSpeeds& set, const WheelSpeeds& now, const Known& known) const
    CARGOBAY_NONBLOCKING {
  const double off = off_mm();
  const double calm_mm = kCalmMm + kCalmMoreIfLostMm * (1.0 - known.carried);
  const double large_mm = std::max(0.0, std::abs(off) - calm_mm);
  const double hurry = known.gains ? known.carried + kHurryIfLost * (1.0 - known.carried) : 0.0;
  const double wanted =
      parameters_.rate_1_s * off + std::copysign(hurry * kHurry1S * large_mm, off);
  const double least = kBackShare * length(set) + kBackLeastMmS;
  double most = least + hurry * (kHurryShare * length(set) + kHurryMmS);
  const auto keep_settled = [&](double set_mm_s, double now_mm_s,
                                double part) CARGOBAY_NONBLOCKING {
    constexpr double kNoPart = 0.01;
    if (std::abs(part) < kNoPart) return;
    const double over_mm_s = part * off > 0.0 ? now_mm_s - set_mm_s : set_mm_s - now_mm_s;
    const double settled_mm_s = std::max(kSettledShare * std::abs(set_mm_s), kSettledMmS);
    most = std::min(most, (settled_mm_s - over_mm_s) / std::abs(part));
  };
  keep_settled(set.left_mm_s, now.left_mm_s, along_.right_mm_s);
  keep_settled(set.right_mm_s, now.right_mm_s, -along_.left_mm_s);
  most = std::max(least, most);
  return std::clamp(wanted, -most, most);
}

WheelSpeeds Course::step(const WheelSpeeds& target, const WheelSpeeds& set, const WheelSpeeds& now,
                         const Ways& ways, const Known& known, double tick_s) CARGOBAY_NONBLOCKING {
  const Ways former = std::exchange(former_, ways);
  const WheelSpeeds former_set = std::exchange(former_set_, set);
  const bool holds = parameters_.hold_heading;
  if (holds) {
    along_ = {std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0};
  } else if (!follows(target, now)) {
    return set;
  }
  const double wanted_mm = holds ? across(former_set) * tick_s : 0.0;
  if_carried_mm_ += across(less(ways.if_carried, former.if_carried)) - wanted_mm;
  if_lost_mm_ += across(less(ways.if_lost, former.if_lost)) - wanted_mm;
  if_carried_mm_ = std::clamp(if_carried_mm_, -kMostCourseMm, kMostCourseMm);
  if_lost_mm_ = std::clamp(if_lost_mm_, -kMostCourseMm, kMostCourseMm);
  error_mm_ = known.carried * if_carried_mm_ + (1.0 - known.carried) * if_lost_mm_;

  go_aside(ways, std::abs(now.left_mm_s + now.right_mm_s) / 2.0 * tick_s, known.carried);
  const double back = holds ? held_back_mm_s(set) : back_mm_s(set, now, known);
  WheelSpeeds corrected = set;
  if (target.left_mm_s != 0.0) corrected.left_mm_s += along_.right_mm_s * back;
  if (target.right_mm_s != 0.0) corrected.right_mm_s -= along_.left_mm_s * back;
  return corrected;
}

}  // namespace cargobay::rt
