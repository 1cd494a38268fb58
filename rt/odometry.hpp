// Where the robot is, going by its wheels: dead reckoning with a covariance that grows.
//
// Each step is an arc. Its uncertainty is the estimator's, plus slip that comes and goes: the
// variance of a wheel's travel grows in proportion to it (K. S. Chong and L. Kleeman, Accurate
// odometry and error modelling for a mobile robot, ICRA 1997). Slip that lasts, tyres, missed
// counts and a wheel base other than was thought are the same all the way, so what they do to the
// pose grows with the way itself, and shrinks again on the way back: it is kept as the pose's
// derivatives by these errors. Travel that is not read yet is uncertain too, but does not add up:
// the next reading settles it. All this is linear in the errors, but for one term of second order:
// a heading that may be wrong by 10 degrees bends the way, so that it ends sooner.
//
// One thread; no allocation.
#pragma once

#include "rt/nonblocking.hpp"
#include "rt/travel.hpp"

namespace cargobay::rt {

// Where the robot believes to be.
struct OdometryPose {
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
    double distance_scale = 1.0;    // true mm for each mm reported
    double turn_scale = 1.0;        // true degrees for each degree reported: tyres, carpet
    double slip_mm2_per_mm = 0.02;  // of one wheel: 4.5 mm, one sigma, after a metre
    // By which part the way of a wheel may be wrong all the time, and by which the wheel base;
    // all of them together are inside the 99 % ellipse.
    double wheel_error = 0.02;
    double base_error = 0.02;
  };

  explicit Odometry(const Parameters& parameters) : parameters_{parameters} {}

  // The robot is known to be at `pose`, for certain.
  void reset(const OdometryPose& pose) CARGOBAY_NONBLOCKING;
  void step(const Travel& travel) CARGOBAY_NONBLOCKING;

  const OdometryPose& pose() const CARGOBAY_NONBLOCKING { return pose_; }
  // Distance travelled; driving backwards reduces it. reset() does not change it.
  double distance_mm() const CARGOBAY_NONBLOCKING { return distance_mm_; }
  PoseCovariance covariance() const CARGOBAY_NONBLOCKING;

 private:
  // What a lasting error of 1 has done to the pose.
  struct Derivative {
    double x_mm = 0.0;
    double y_mm = 0.0;
    double heading_rad = 0.0;
  };
  void derive(Derivative& by, double chord_mm, double by_distance_mm, double by_turn_rad) const
      CARGOBAY_NONBLOCKING;
  void bend(double turn_rad) CARGOBAY_NONBLOCKING;
  double lasting_heading_variance() const CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  OdometryPose pose_{};
  double read_x_mm_ = 0.0;  // where the last reading corrected the turn
  double read_y_mm_ = 0.0;
  double distance_mm_ = 0.0;
  PoseCovariance grown_{};
  Derivative by_left_{};  // way
  Derivative by_right_{};
  Derivative by_base_{};
  // How much shorter the way is for being bent by what the heading may be wrong by: on average.
  double bent_x_mm_ = 0.0;
  double bent_y_mm_ = 0.0;
  double cos_ = 1.0;  // of the heading in the middle of the last step
  double sin_ = 0.0;
  double unread_distance_ = 0.0;
  double unread_turn_ = 0.0;
};

}  // namespace cargobay::rt
