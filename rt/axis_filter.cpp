#include "rt/axis_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cargobay::rt {
namespace {

constexpr double kInitialDisturbanceSd = 5.0;  // mm/s: at rest nothing is lost
constexpr double kLeastProbability = 1e-4;     // no single reading may decide everything

double normal_density(double z) noexcept CARGOBAY_NONBLOCKING {
  return std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}

// Probability between a and b, a < b, without cancellation in the tails.
double normal_between(double a, double b) noexcept CARGOBAY_NONBLOCKING {
  if (a > 0.0) return normal_between(-b, -a);
  return 0.5 * (std::erfc(-b / std::numbers::sqrt2) - std::erfc(-a / std::numbers::sqrt2));
}

struct Moments {
  double mean;
  double variance;
  double probability;
};

// A normal distribution conditioned on an interval.
Moments truncate(double mean, double variance, double low,
                 double high) noexcept CARGOBAY_NONBLOCKING {
  constexpr double kTooFar = 1e-9;
  const double sd = std::sqrt(variance);
  const double a = (low - mean) / sd;
  const double b = (high - mean) / sd;
  const double probability = normal_between(a, b);
  if (probability < kTooFar) {  // all the mass left sits at the nearer edge
    const double width = high - low;
    const double edge = mean < low ? low + 0.1 * width : high - 0.1 * width;
    return {edge, 0.01 * width * width, probability};
  }
  const double density_a = normal_density(a);
  const double density_b = normal_density(b);
  const double shift = (density_a - density_b) / probability;
  const double shrink = 1.0 + (a * density_a - b * density_b) / probability - shift * shift;
  return {mean + sd * shift, variance * std::clamp(shrink, 1e-6, 1.0), probability};
}

}  // namespace

AxisFilter::AxisFilter(const Parameters& parameters) : parameters_{parameters} {
  const double lag = parameters.lag_s;
  const double tick = parameters.tick_s;
  const double decay = std::exp(-tick / lag);
  const double travel = lag * (1.0 - decay);  // mm for 1 mm/s of initial speed
  transition_ << 1.0, travel, tick - travel,  //
      0.0, decay, 1.0 - decay,                //
      0.0, 0.0, 1.0;
  coasting_ << transition_;
  coasting_(kPosition, kDisturbance) = 0.0;
  coasting_(kSpeed, kDisturbance) = 0.0;
  input_ << tick - travel, 1.0 - decay, 0.0;
  reset();
}

void AxisFilter::reset() noexcept CARGOBAY_NONBLOCKING {
  state_.setZero();
  read_mm_ = 0.0;
  forgotten_ = 0.0;
  covariance_.setZero();
  covariance_(kPosition, kPosition) = parameters_.step_mm * parameters_.step_mm / 3.0;
  covariance_(kDisturbance, kDisturbance) = kInitialDisturbanceSd * kInitialDisturbanceSd;
}

void AxisFilter::predict(double command_mm_s, double disturbance_sd_mm_s,
                         double position_sd_mm) noexcept CARGOBAY_NONBLOCKING {
  propagate(transition_, std::hypot(parameters_.disturbance_noise_mm_s, disturbance_sd_mm_s),
            position_sd_mm);
  state_ += input_ * command_mm_s;
}

void AxisFilter::coast(double disturbance_sd_mm_s,
                       double position_sd_mm) noexcept CARGOBAY_NONBLOCKING {
  propagate(coasting_, disturbance_sd_mm_s, position_sd_mm);
}

void AxisFilter::propagate(const Eigen::Matrix3d& transition, double disturbance_sd_mm_s,
                           double position_sd_mm) noexcept CARGOBAY_NONBLOCKING {
  state_ = (transition * state_).eval();
  covariance_ = (transition * covariance_ * transition.transpose()).eval();
  const double speed_noise = parameters_.speed_noise_mm_s;
  covariance_(kPosition, kPosition) += position_sd_mm * position_sd_mm;
  covariance_(kSpeed, kSpeed) += speed_noise * speed_noise;
  covariance_(kDisturbance, kDisturbance) += disturbance_sd_mm_s * disturbance_sd_mm_s;
}

double AxisFilter::read(int count, Remainder remainder) noexcept CARGOBAY_NONBLOCKING {
  const double step = parameters_.step_mm;
  const double low = (count > 0 ? count : count - 1) * step;
  const double high = (count < 0 ? count : count + 1) * step;
  const double noise = parameters_.counter_noise_mm;
  const double variance = covariance_(kPosition, kPosition) + noise * noise;
  const Moments seen = truncate(state_[kPosition], variance, low, high);

  const Eigen::Vector3d gain = covariance_.col(kPosition) / variance;
  state_ += gain * (seen.mean - state_[kPosition]);
  covariance_ -= gain * gain.transpose() * (variance - seen.variance);

  if (remainder == Remainder::carried) {
    state_[kPosition] -= count * step;
    read_mm_ += count * step;
  } else {
    forget_position(0.0);
  }
  return std::log(kLeastProbability + (1.0 - kLeastProbability) * seen.probability);
}

void AxisFilter::read_unseen(Remainder remainder) noexcept CARGOBAY_NONBLOCKING {
  const double step = parameters_.step_mm;
  if (remainder == Remainder::lost) return forget_position(0.0);
  // A robot that carries it has kept half a step, on average, which the next reading tells again.
  const bool moves = std::abs(state_[kSpeed]) * parameters_.tick_s > step / 100.0;
  if (moves) read_mm_ -= std::copysign(step / 2.0, state_[kSpeed]);
  forget_position(step * step / 3.0);
}

void AxisFilter::forget_position(double variance) noexcept CARGOBAY_NONBLOCKING {
  read_mm_ += state_[kPosition];
  forgotten_ += covariance_(kPosition, kPosition);
  state_[kPosition] = 0.0;
  covariance_.row(kPosition).setZero();
  covariance_.col(kPosition).setZero();
  covariance_(kPosition, kPosition) = variance;
}

}  // namespace cargobay::rt
