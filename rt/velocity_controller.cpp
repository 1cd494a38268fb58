#include "rt/velocity_controller.hpp"

#include <algorithm>

namespace cargobay::rt {

double VelocityController::step(double set_mm_s, double set_rate_mm_s2, double estimate_mm_s)
    CARGOBAY_NONBLOCKING {
  const double limit = parameters_.max_command_mm_s;
  const double error_mm_s = set_mm_s - estimate_mm_s;
  const double forward_mm_s = set_mm_s + parameters_.lag_s * set_rate_mm_s2;
  const double integral_mm_s =
      integral_mm_s_ + parameters_.integral_per_s * parameters_.tick_s * error_mm_s;
  const double wanted_mm_s = forward_mm_s + parameters_.proportional * error_mm_s + integral_mm_s;
  const double command_mm_s = std::clamp(wanted_mm_s, -limit, limit);
  const bool saturated = command_mm_s != wanted_mm_s;
  const bool pushes_further = (wanted_mm_s > command_mm_s) == (error_mm_s > 0.0);
  if (!saturated || !pushes_further) integral_mm_s_ = integral_mm_s;
  return command_mm_s;
}

}  // namespace cargobay::rt
