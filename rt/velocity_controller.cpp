#include "rt/velocity_controller.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::rt {
namespace {

constexpr double kCaution = 1.3;  // standard deviations of the gain
constexpr double kMostGain = 1.15;
constexpr double kRollsMmS = 10.0;  // slower, its direction is not sure

}  // namespace

double VelocityController::most_mm_s(double set_mm_s) CARGOBAY_NONBLOCKING {
  return (kMostOverSet * std::abs(set_mm_s) + kMostBeyondMmS) / kMostGain;
}

double VelocityController::command(const Wish& wish, const Wheel& wheel) const
    CARGOBAY_NONBLOCKING {
  const double largest = std::max({std::abs(wish.set_mm_s), std::abs(wish.target_mm_s), 1.0});
  const double room =
      std::max(parameters_.overshoot_share, parameters_.overshoot_mm_s / largest) * wheel.gain;
  const double gain = wheel.gain + std::max(0.0, kCaution * wheel.gain_sd - room);
  const double lead_mm_s = wish.ahead_mm_s + wheel.lag_s * wish.rate_mm_s2;
  const double feedback_mm_s =
      wheel.proportional * (wish.set_mm_s - wheel.speed_mm_s) - wheel.disturbance_mm_s;
  const double most_mm_s = VelocityController::most_mm_s(
      std::max(std::abs(wish.asked_mm_s), std::abs(wish.target_mm_s)));
  const double wanted_mm_s = std::clamp((lead_mm_s + feedback_mm_s) / gain, -most_mm_s, most_mm_s);
  if (std::abs(wheel.speed_mm_s) > kRollsMmS && wanted_mm_s * wheel.speed_mm_s < 0.0) return 0.0;
  // The end of a way down is led by less than nothing, but a wheel is stopped by 0.
  if (wish.target_mm_s == 0.0 && wanted_mm_s * wish.set_mm_s < 0.0) return 0.0;
  const double limit = parameters_.max_command_mm_s;
  return std::clamp(wanted_mm_s, -limit, limit);
}

}  // namespace cargobay::rt
