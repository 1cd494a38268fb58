#include "rt/odometry.hpp"

#include <cmath>

namespace cargobay::rt {
namespace {

// All three at their bounds are inside the 99 % ellipse, with room for what else is wrong.
double variance_of(double most) CARGOBAY_NONBLOCKING { return most * most / 2.0; }

}  // namespace

void Odometry::reset(const OdometryPose& pose) CARGOBAY_NONBLOCKING {
  pose_ = pose;
  read_x_mm_ = pose.x_mm;
  read_y_mm_ = pose.y_mm;
  grown_ = {};
  by_left_ = {};
  by_right_ = {};
  by_base_ = {};
  bent_x_mm_ = 0.0;
  bent_y_mm_ = 0.0;
}

// One step: its heading was wrong already, and it is wrong itself.
void Odometry::derive(Derivative& by, double chord_mm, double by_distance_mm,
                      double by_turn_rad) const CARGOBAY_NONBLOCKING {
  const double middle_rad = by.heading_rad + by_turn_rad / 2.0;
  by.x_mm += cos_ * by_distance_mm - sin_ * chord_mm * middle_rad;
  by.y_mm += sin_ * by_distance_mm + cos_ * chord_mm * middle_rad;
  by.heading_rad += by_turn_rad;
}

double Odometry::lasting_heading_variance() const CARGOBAY_NONBLOCKING {
  const double of_wheels =
      by_left_.heading_rad * by_left_.heading_rad + by_right_.heading_rad * by_right_.heading_rad;
  return variance_of(parameters_.wheel_error) * of_wheels +
         variance_of(parameters_.base_error) * by_base_.heading_rad * by_base_.heading_rad;
}

// The turn that a reading found has come about since the one before, evenly, so that half of it
// was missing on the way between them.
void Odometry::bend(double turn_rad) CARGOBAY_NONBLOCKING {
  const double x_mm = pose_.x_mm - read_x_mm_;
  const double y_mm = pose_.y_mm - read_y_mm_;
  pose_.x_mm -= y_mm * turn_rad / 2.0;
  pose_.y_mm += x_mm * turn_rad / 2.0;
  read_x_mm_ = pose_.x_mm;
  read_y_mm_ = pose_.y_mm;
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
  const double left_way_mm = distance_mm - turn_rad * base_mm / 2.0;
  const double right_way_mm = distance_mm + turn_rad * base_mm / 2.0;
  const double left_mm = std::abs(left_way_mm);
  const double right_mm = std::abs(right_way_mm);
  const double ahead = travel.distance_variance + slip * (left_mm + right_mm) / 4.0;
  const double both = slip * (right_mm - left_mm) / (2.0 * base_mm);
  const double turned = travel.turn_variance + slip * (left_mm + right_mm) / (base_mm * base_mm);
  p.xx += cos_ * cos_ * ahead;
  p.xy += cos_ * sin_ * ahead;
  p.yy += sin_ * sin_ * ahead;
  p.xh += cos_ * both;
  p.yh += sin_ * both;
  p.hh += turned;

  derive(by_left_, chord_mm, left_way_mm / 2.0, -left_way_mm / base_mm);
  derive(by_right_, chord_mm, right_way_mm / 2.0, right_way_mm / base_mm);
  derive(by_base_, chord_mm, 0.0, -turn_rad);

  const double bends = (p.hh + lasting_heading_variance()) / 2.0;
  bent_x_mm_ += bends * x_mm;
  bent_y_mm_ += bends * y_mm;

  pose_.x_mm += x_mm;
  pose_.y_mm += y_mm;
  pose_.heading_rad += turn_rad;
  distance_mm_ += distance_mm;
  if (travel.turn_corrected_rad != 0.0) bend(travel.turn_corrected_rad * parameters_.turn_scale);
  unread_distance_ = travel.unread_distance_variance;
  unread_turn_ = travel.unread_turn_variance;
}

PoseCovariance Odometry::covariance() const CARGOBAY_NONBLOCKING {
  PoseCovariance now = grown_;
  now.xx += cos_ * cos_ * unread_distance_;
  now.xy += cos_ * sin_ * unread_distance_;
  now.yy += sin_ * sin_ * unread_distance_;
  now.hh += unread_turn_;
  const double of_wheel = variance_of(parameters_.wheel_error);
  const auto add = [&now](const Derivative& by, double variance) CARGOBAY_NONBLOCKING {
    now.xx += variance * by.x_mm * by.x_mm;
    now.xy += variance * by.x_mm * by.y_mm;
    now.xh += variance * by.x_mm * by.heading_rad;
    now.yy += variance * by.y_mm * by.y_mm;
    now.yh += variance * by.y_mm * by.heading_rad;
    now.hh += variance * by.heading_rad * by.heading_rad;
  };
  add(by_left_, of_wheel);
  add(by_right_, of_wheel);
  add(by_base_, variance_of(parameters_.base_error));
  // The fourth moment of a heading that is wrong all the way.
  add({.x_mm = bent_x_mm_, .y_mm = bent_y_mm_}, 3.0);
  return now;
}

}  // namespace cargobay::rt
