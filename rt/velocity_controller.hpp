// A wheel's velocity controller: feed-forward through the inverse of the wheel's lag, and a PI on
// the estimate for what the model does not know (droop, friction, load).
#pragma once

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class VelocityController {
 public:
  struct Parameters {
    double lag_s = 0.100;             // of the wheel, for the feed-forward
    double proportional = 0.3;        // mm/s of command for 1 mm/s of error
    double integral_per_s = 4.0;      // mm/s of command, each second, for 1 mm/s of error
    double max_command_mm_s = 500.0;  // the robot's range
    double tick_s = 0.015;
  };

  explicit VelocityController(const Parameters& parameters) : parameters_{parameters} {}

  void reset() CARGOBAY_NONBLOCKING { integral_mm_s_ = 0.0; }

  // One tick. The set speed and its rate of change; the estimated speed. Returns the command,
  // within +-max_command_mm_s. The integral does not grow while the command is at its limit.
  double step(double set_mm_s, double set_rate_mm_s2, double estimate_mm_s) CARGOBAY_NONBLOCKING;

  double integral_mm_s() const CARGOBAY_NONBLOCKING { return integral_mm_s_; }

 private:
  Parameters parameters_;
  double integral_mm_s_ = 0.0;
};

}  // namespace cargobay::rt
