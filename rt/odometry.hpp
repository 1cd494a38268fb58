// Where the robot is, by what its wheels did: dead reckoning with a covariance that grows.
//
// Each step is an arc. Its uncertainty is what the estimator says, and slip: a wheel's way is wrong
// by a variance in proportion to it (K. S. Chong and L. Kleeman, Accurate odometry and error
// modelling for a mobile robot, ICRA 1997). What is not read yet is uncertain too, but does not add
// up: the next reading tells it.
//
// One thread; no allocation.
#pragma once

#include "rt/nonblocking.hpp"
#include "rt/travel.hpp"

namespace cargobay::rt {

struct Pose {
  double x_mm = 0.0;         // ahead at heading 0
  double y_mm = 0.0;         // to the left of that
  double heading_rad = 0.0;  // counter-clockwise, not wrapped
};

// Of a pose, symmetric; h is the heading.
struct PoseCovariance {
  double xx = 0.0;  // mm^2
  double xy = 0.0;
  double xh = 0.0;  // mm rad
  double yy = 0.0;
  double yh = 0.0;
  double hh = 0.0;  // rad^2
};

class Odometry {
 public:
  struct Parameters {
    double wheel_base_mm = 258.0;
    double distance_scale = 1.0;    // true distance for each mm reported, and
    double turn_scale = 1.0;        // turn for each degree: tyres, carpet
    double slip_mm2_per_mm = 0.02;  // of one wheel: 4.5 mm, one sigma, behind a metre
  };

  explicit Odometry(const Parameters& parameters) : parameters_{parameters} {}

  // The robot is there, for certain.
  void reset(const Pose& pose) CARGOBAY_NONBLOCKING;
  void step(const Travel& travel) CARGOBAY_NONBLOCKING;

  const Pose& pose() const CARGOBAY_NONBLOCKING { return pose_; }
  // The way gone; backwards counts down. reset() leaves it.
  double distance_mm() const CARGOBAY_NONBLOCKING { return distance_mm_; }
  PoseCovariance covariance() const CARGOBAY_NONBLOCKING;

 private:
  Parameters parameters_;
  Pose pose_{};
  double distance_mm_ = 0.0;
  PoseCovariance grown_{};
  double cos_ = 1.0;  // of the heading in the middle of the last step
  double sin_ = 0.0;
  double unread_distance_ = 0.0;
  double unread_turn_ = 0.0;
};

}  // namespace cargobay::rt
