#include "rt/odometry.hpp"

#include <cmath>

namespace cargobay::rt {

void Odometry::reset(const OdometryPose& pose) CARGOBAY_NONBLOCKING {
  pose_ = pose;
  grown_ = {};
}

void Odometry::step(const Travel& travel) CARGOBAY_NONBLOCKING {
  const double base_mm = parameters_.wheel_base_mm;
  const double distance_mm = travel.distance_mm * parameters_.distance_scale;
  const double turn_rad = travel.turn_rad * parameters_.turn_scale;
  const double middle_rad = pose_.heading_rad + turn_rad / 2.0;
  cos_ = std::cos(middle_rad);
  sin_ = std::sin(middle_rad);
  // The chord of the arc; one step turns so little that a series is exact.
  const double chord_mm = distance_mm * (1.0 - turn_rad * turn_rad / 24.0);
  const double x_mm = chord_mm * cos_;
  const double y_mm = chord_mm * sin_;

  // The heading was already uncertain, so the step errs sideways. Written out, since most terms of
  // the matrix product are 0.
  PoseCovariance& p = grown_;
  p.xx += -2.0 * y_mm * p.xh + y_mm * y_mm * p.hh;
  p.xy += x_mm * p.xh - y_mm * p.yh - x_mm * y_mm * p.hh;
  p.yy += 2.0 * x_mm * p.yh + x_mm * x_mm * p.hh;
  p.xh -= y_mm * p.hh;
  p.yh += x_mm * p.hh;

  // And the step itself: in distance, in turn, and in both at once if one wheel slips more.
  const double slip = parameters_.slip_mm2_per_mm;
  const double left_mm = std::abs(distance_mm - turn_rad * base_mm / 2.0);
  const double right_mm = std::abs(distance_mm + turn_rad * base_mm / 2.0);
  const double ahead = travel.distance_variance + slip * (left_mm + right_mm) / 4.0;
  const double both = slip * (right_mm - left_mm) / (2.0 * base_mm);
  const double turned = travel.turn_variance + slip * (left_mm + right_mm) / (base_mm * base_mm);
  p.xx += cos_ * cos_ * ahead;
  p.xy += cos_ * sin_ * ahead;
  p.yy += sin_ * sin_ * ahead;
  p.xh += cos_ * both;
  p.yh += sin_ * both;
  p.hh += turned;

  pose_.x_mm += x_mm;
  pose_.y_mm += y_mm;
  pose_.heading_rad += turn_rad;
  distance_mm_ += distance_mm;
  unread_distance_ = travel.unread_distance_variance;
  unread_turn_ = travel.unread_turn_variance;
}

PoseCovariance Odometry::covariance() const CARGOBAY_NONBLOCKING {
  PoseCovariance now = grown_;
  now.xx += cos_ * cos_ * unread_distance_;
  now.xy += cos_ * sin_ * unread_distance_;
  now.yy += sin_ * sin_ * unread_distance_;
  now.hh += unread_turn_;
  return now;
}

}  // namespace cargobay::rt
