#include "hal/sim/drive_train/odometer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cargobay::hal::sim {

namespace {

constexpr double kLowest = std::numeric_limits<std::int16_t>::min();
constexpr double kHighest = std::numeric_limits<std::int16_t>::max();

}  // namespace

Odometer::Odometer(const Parameters& parameters)
    : remainder_{parameters.remainder},
      mm_per_count_{1.0 / parameters.wheels.counts_per_mm},
      deg_per_mm_{180.0 / std::numbers::pi / parameters.wheels.wheel_base_mm} {}

void Odometer::set(const WheelParameters& parameters) {
  mm_per_count_ = 1.0 / parameters.counts_per_mm;
  deg_per_mm_ = 180.0 / std::numbers::pi / parameters.wheel_base_mm;
}

void Odometer::latch(std::int64_t left_counts, std::int64_t right_counts) {
  const double left_mm = static_cast<double>(left_counts - left_counts_) * mm_per_count_;
  const double right_mm = static_cast<double>(right_counts - right_counts_) * mm_per_count_;
  left_counts_ = left_counts;
  right_counts_ = right_counts;
  // If they are not polled often enough, the sums saturate (OI p. 18).
  distance_mm_ = std::clamp(distance_mm_ + 0.5 * (left_mm + right_mm), kLowest, kHighest);
  angle_deg_ = std::clamp(angle_deg_ + (right_mm - left_mm) * deg_per_mm_, kLowest, kHighest);
}

oi::Mm Odometer::take_distance() { return oi::Mm{take(distance_mm_)}; }

oi::Deg Odometer::take_angle() { return oi::Deg{take(angle_deg_)}; }

std::int32_t Odometer::take(double& sum) const {
  const double whole = std::trunc(sum);
  sum = remainder_ == Remainder::carried ? sum - whole : 0.0;
  return static_cast<std::int32_t>(whole);
}

}  // namespace cargobay::hal::sim
