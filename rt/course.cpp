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
constexpr double kMostAsideMm = 6.0;    // 2 degrees
constexpr double kSameCurve = 1e-3;     // sine of the angle between two directions
constexpr double kMostCourseMm = 64.0;  // across, both wheels together: 20 degrees
// Of the set speed, for what is taken back: the wheels stay within what is called settled.
constexpr double kBackShare = 0.007;
constexpr double kBackLeastMmS = 0.4;
constexpr double kBackShareHolding = 0.08;
constexpr double kBackLeastHoldingMmS = 4.0;

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

WheelSpeeds Course::step(const WheelSpeeds& target, const WheelSpeeds& set, const WheelSpeeds& now,
                         const Ways& ways, double carried, double tick_s) CARGOBAY_NONBLOCKING {
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
  error_mm_ = carried * if_carried_mm_ + (1.0 - carried) * if_lost_mm_;

  const double most = holds ? kBackShareHolding * length(set) + kBackLeastHoldingMmS
                            : kBackShare * length(set) + kBackLeastMmS;
  const double speed = std::abs(now.left_mm_s + now.right_mm_s) / 2.0;
  aside_mm_ = std::clamp(aside_mm_ + error_mm_ * speed * tick_s / kBackWithinMm, -kMostAsideMm,
                         kMostAsideMm);
  const double rate = holds ? parameters_.holding_rate_1_s : parameters_.rate_1_s;
  const double back = std::clamp(rate * (error_mm_ + aside_mm_), -most, most);
  WheelSpeeds corrected = set;
  if (target.left_mm_s != 0.0) corrected.left_mm_s += along_.right_mm_s * back;
  if (target.right_mm_s != 0.0) corrected.right_mm_s -= along_.left_mm_s * back;
  return corrected;
}

}  // namespace cargobay::rt
