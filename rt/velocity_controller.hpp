// A wheel's velocity controller: the command that should bring the wheel to its set speed, through
// what is known of the wheel.
//
// There is no integral of its own to wind up. What the wheel falls short by is a state of the
// estimator (rt/wheel_estimator.hpp), which knows what has been commanded and when it acts, so a
// wheel that still speeds up, waits or ramps is not pushed. (C. E. Garcia and M. Morari, Internal
// model control, Ind. Eng. Chem. Process Des. Dev. 21, 1982.)
#pragma once

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class VelocityController {
 public:
  struct Parameters {
    double max_command_mm_s = 500.0;  // the robot's range
    // A set speed may be overshot by the larger of these while the gain is not known better.
    double overshoot_share = 0.06;
    double overshoot_mm_s = 10.0;
  };

  // What is known of the wheel now.
  struct Wheel {
    double gain = 1.0;  // mm/s for each commanded mm/s; above 0
    double gain_sd = 0.0;
    double lag_s = 0.0;             // that it surely has
    double proportional = 0.0;      // mm/s of drive for each mm/s of error
    double disturbance_mm_s = 0.0;  // as AxisFilter has it
    double speed_mm_s = 0.0;
  };
  struct Wish {
    double asked_mm_s = 0.0;   // now
    double set_mm_s = 0.0;     // the same, and what the course takes back
    double ahead_mm_s = 0.0;   // when the command will act
    double rate_mm_s2 = 0.0;   // at which it changes then
    double target_mm_s = 0.0;  // and where to
  };

  // Whatever the readings say, no wheel is commanded to more than these times its set speed, or its
  // target if that is faster, and these mm/s beyond it, for the strongest motor.
  static constexpr double kMostOverSet = 1.7;
  static constexpr double kMostBeyondMmS = 50.0;

  // The most that a wheel is commanded to for a set speed or target, whatever the readings say;
  // without the robot's range.
  static double most_mm_s(double set_mm_s) CARGOBAY_NONBLOCKING;

  explicit VelocityController(const Parameters& parameters) : parameters_{parameters} {}

  // The command, within +-max_command_mm_s; never against the direction in which the wheel rolls,
  // since its counter would run backwards.
  double command(const Wish& wish, const Wheel& wheel) const CARGOBAY_NONBLOCKING;

 private:
  Parameters parameters_;
};

}  // namespace cargobay::rt
