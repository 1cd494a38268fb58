// A Kalman filter for one axis of motion, measured by a counter that truncates to whole steps.
//
// States: position since the counter was last read, speed, and a disturbance: how much faster the
// wheels end up than they are driven at. Speed follows both with a first-order lag.
//
// A reading z means that the position lies in an interval, not at a point: [z, z+1) steps going
// forward, (z-1, z] going back, (-1, 1) at 0. The update conditions the state on that interval by
// the moments of the truncated normal distribution, so an axis too slow to count for many ticks
// teaches what it can and nothing more. The probability of the reading comes out of the update and
// tells hypotheses apart.
#pragma once

#include <array>
#include <cstddef>

#include "rt/nonblocking.hpp"
#include "rt/remainder.hpp"

namespace cargobay::rt {

class AxisFilter {
 public:
  struct Parameters {
    double step_mm = 1.0;                 // one count, in mm along the axis (above 0)
    double tick_s = 0.015;                // above 0
    double speed_noise_mm_s = 2.0;        // standard deviation added to the speed each tick
    double disturbance_noise_mm_s = 1.0;  // the same for the disturbance
    double disturbance_lag_s = 0.200;     // in which it fades (above 0)
    double counter_noise_mm = 0.15;       // encoder resolution and the like
  };

  // What one tick does to position and speed.
  struct Response {
    double position_by_speed = 0.0;  // s
    double position_by_input = 0.0;  // s
    double speed_by_speed = 0.0;
    double speed_by_input = 0.0;
  };
  // With a first-order lag; both above 0.
  static Response response(double lag_s, double tick_s) CARGOBAY_NONBLOCKING;

  // Standard deviations of one tick, beside those of the parameters.
  struct Doubt {
    double speed_mm_s = 0.0;
    // How far the counter may have gone wrong: a wheel that coasts against its commanded direction
    // counts backwards.
    double position_mm = 0.0;
  };

  explicit AxisFilter(const Parameters& parameters);

  // Back to standstill, with nothing known about the disturbance.
  void reset() CARGOBAY_NONBLOCKING;

  // One tick in which the wheels are driven at `driven_mm_s` in the mean.
  void predict(double driven_mm_s, const Response& response, const Doubt& doubt)
      CARGOBAY_NONBLOCKING;

  // The same without a drive: then nothing is disturbed either.
  void coast(const Response& response, const Doubt& doubt) CARGOBAY_NONBLOCKING;

  // The speed has been wrong in one sense since the counter was last read, by which the position is
  // wrong too: standard deviations of both.
  void doubt_all_along(double position_mm, double speed_mm_s) CARGOBAY_NONBLOCKING;

  // The counter was read and said `count`. Returns the natural logarithm of the probability that
  // this filter gave that count.
  double read(int count, Remainder remainder) CARGOBAY_NONBLOCKING;

  // The counter was read, but its value is not known.
  void read_unseen(Remainder remainder) CARGOBAY_NONBLOCKING;

  double speed_mm_s() const CARGOBAY_NONBLOCKING { return state_[kSpeed]; }
  // Travel since reset(): what was read, plus the filter's estimate of what was not. A reading may
  // take back a little of an earlier estimate.
  double travel_mm() const CARGOBAY_NONBLOCKING { return read_mm_ + state_[kPosition]; }
  // The part of it that was not read yet.
  double unread_mm() const CARGOBAY_NONBLOCKING { return state_[kPosition]; }
  // How wrong that may be. The first is what readings have lost for good, and grows with each; the
  // second is what the next reading will settle, and does not.
  double forgotten_variance() const CARGOBAY_NONBLOCKING { return forgotten_; }
  double unread_variance() const CARGOBAY_NONBLOCKING {
    return covariance_[kPosition * kStates + kPosition];
  }
  double disturbance_mm_s() const CARGOBAY_NONBLOCKING { return state_[kDisturbance]; }
  double speed_variance() const CARGOBAY_NONBLOCKING {
    return covariance_[kSpeed * kStates + kSpeed];
  }

 private:
  static constexpr std::size_t kPosition = 0;
  static constexpr std::size_t kSpeed = 1;
  static constexpr std::size_t kDisturbance = 2;
  static constexpr std::size_t kStates = 3;

  void propagate(const Response& tick, double disturbance_sd_mm_s, const Doubt& doubt)
      CARGOBAY_NONBLOCKING;
  void forget_position(double variance) CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  double keep_;  // of the disturbance, from tick to tick
  // The source maps these to a vector and a matrix, so that includers of this header need no Eigen.
  std::array<double, kStates> state_{};
  std::array<double, kStates * kStates> covariance_{};
  double read_mm_ = 0.0;    // travel up to where state_'s position begins
  double forgotten_ = 0.0;  // mm^2
};

}  // namespace cargobay::rt
