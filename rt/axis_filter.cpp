#include "rt/axis_filter.hpp"

#include <cmath>

#include <Eigen/Core>

#include "rt/truncated_normal.hpp"

namespace cargobay::rt {
namespace {

constexpr double kInitialDisturbanceSd = 1.0;  // mm/s
constexpr double kLeastProbability = 1e-4;     // no single reading may decide everything

using State = Eigen::Map<Eigen::Vector3d>;
using Covariance = Eigen::Map<Eigen::Matrix3d>;

}  // namespace

AxisFilter::Response AxisFilter::response(double lag_s, double tick_s) CARGOBAY_NONBLOCKING {
  const double decay = std::exp(-tick_s / lag_s);
  const double travel = lag_s * (1.0 - decay);  // mm for 1 mm/s of initial speed
  return {.position_by_speed = travel,
          .position_by_input = tick_s - travel,
          .speed_by_speed = decay,
          .speed_by_input = 1.0 - decay};
}

AxisFilter::AxisFilter(const Parameters& parameters)
    : parameters_{parameters}, keep_{std::exp(-parameters.tick_s / parameters.disturbance_lag_s)} {
  reset();
}

void AxisFilter::reset() CARGOBAY_NONBLOCKING {
  state_ = {};
  read_mm_ = 0.0;
  forgotten_ = 0.0;
  covariance_ = {};
  Covariance covariance{covariance_.data()};
  covariance(kPosition, kPosition) = parameters_.step_mm * parameters_.step_mm / 3.0;
  covariance(kDisturbance, kDisturbance) = kInitialDisturbanceSd * kInitialDisturbanceSd;
}

void AxisFilter::predict(double driven_mm_s, const Response& response, const Doubt& doubt)
    CARGOBAY_NONBLOCKING {
  propagate(response, parameters_.disturbance_noise_mm_s, doubt);
  state_[kPosition] += response.position_by_input * driven_mm_s;
  state_[kSpeed] += response.speed_by_input * driven_mm_s;
}

void AxisFilter::coast(const Response& response, const Doubt& doubt) CARGOBAY_NONBLOCKING {
  Response coasting = response;
  coasting.position_by_input = 0.0;
  coasting.speed_by_input = 0.0;
  propagate(coasting, 0.0, doubt);
}

// F x and F P F' written out: most of F is 0 or 1, and P is symmetric. Takes a third of the
// instructions of the matrix products.
void AxisFilter::propagate(const Response& tick, double disturbance_sd_mm_s, const Doubt& doubt)
    CARGOBAY_NONBLOCKING {
  const auto& [position_by_speed, position_by_input, speed_by_speed, speed_by_input] = tick;
  const double speed = state_[kSpeed];
  const double input = state_[kDisturbance];
  state_[kPosition] += position_by_speed * speed + position_by_input * input;
  state_[kSpeed] = speed_by_speed * speed + speed_by_input * input;
  state_[kDisturbance] = keep_ * input;

  Covariance p{covariance_.data()};
  const double speed_speed = p(kSpeed, kSpeed);
  const double speed_input = p(kSpeed, kDisturbance);
  const double input_input = p(kDisturbance, kDisturbance);
  // The entries of F P that are needed.
  const double position_position = p(kPosition, kPosition) +
                                   position_by_speed * p(kPosition, kSpeed) +
                                   position_by_input * p(kPosition, kDisturbance);
  const double position_speed =
      p(kPosition, kSpeed) + position_by_speed * speed_speed + position_by_input * speed_input;
  const double position_input = p(kPosition, kDisturbance) + position_by_speed * speed_input +
                                position_by_input * input_input;
  const double moved_speed_speed = speed_by_speed * speed_speed + speed_by_input * speed_input;
  const double moved_speed_input = speed_by_speed * speed_input + speed_by_input * input_input;

  const double speed_variance = parameters_.speed_noise_mm_s * parameters_.speed_noise_mm_s +
                                doubt.speed_mm_s * doubt.speed_mm_s;
  p(kPosition, kPosition) = position_position + position_by_speed * position_speed +
                            position_by_input * position_input +
                            doubt.position_mm * doubt.position_mm;
  p(kPosition, kSpeed) = p(kSpeed, kPosition) =
      speed_by_speed * position_speed + speed_by_input * position_input;
  p(kPosition, kDisturbance) = p(kDisturbance, kPosition) = keep_ * position_input;
  p(kSpeed, kSpeed) =
      speed_by_speed * moved_speed_speed + speed_by_input * moved_speed_input + speed_variance;
  p(kSpeed, kDisturbance) = p(kDisturbance, kSpeed) = keep_ * moved_speed_input;
  p(kDisturbance, kDisturbance) =
      keep_ * keep_ * input_input + disturbance_sd_mm_s * disturbance_sd_mm_s;
}

void AxisFilter::doubt_all_along(double position_mm, double speed_mm_s) CARGOBAY_NONBLOCKING {
  Covariance p{covariance_.data()};
  p(kPosition, kPosition) += position_mm * position_mm;
  p(kPosition, kSpeed) += position_mm * speed_mm_s;
  p(kSpeed, kPosition) += position_mm * speed_mm_s;
  p(kSpeed, kSpeed) += speed_mm_s * speed_mm_s;
}

double AxisFilter::read(int count, Remainder remainder) CARGOBAY_NONBLOCKING {
  const double step = parameters_.step_mm;
  const double low = (count > 0 ? count : count - 1) * step;
  const double high = (count < 0 ? count : count + 1) * step;
  const double noise = parameters_.counter_noise_mm;
  State state{state_.data()};
  Covariance covariance{covariance_.data()};
  const double variance = covariance(kPosition, kPosition) + noise * noise;
  const TruncatedNormal seen = truncate(state_[kPosition], variance, low, high);

  const Eigen::Vector3d gain = covariance.col(kPosition) / variance;
  state += gain * (seen.mean - state_[kPosition]);
  covariance -= gain * gain.transpose() * (variance - seen.variance);

  if (remainder == Remainder::carried) {
    state_[kPosition] -= count * step;
    read_mm_ += count * step;
  } else {
    forget_position(0.0);
  }
  return std::log(kLeastProbability + (1.0 - kLeastProbability) * seen.probability);
}

void AxisFilter::read_unseen(Remainder remainder) CARGOBAY_NONBLOCKING {
  const double step = parameters_.step_mm;
  if (remainder == Remainder::lost) return forget_position(0.0);
  // A robot that carries it has kept half a step, on average, which the next reading will report.
  const bool moves = std::abs(state_[kSpeed]) * parameters_.tick_s > step / 100.0;
  if (moves) read_mm_ -= std::copysign(step / 2.0, state_[kSpeed]);
  forget_position(step * step / 3.0);
}

void AxisFilter::forget_position(double variance) CARGOBAY_NONBLOCKING {
  read_mm_ += state_[kPosition];
  Covariance covariance{covariance_.data()};
  forgotten_ += covariance(kPosition, kPosition);
  state_[kPosition] = 0.0;
  covariance.row(kPosition).setZero();
  covariance.col(kPosition).setZero();
  covariance(kPosition, kPosition) = variance;
}

}  // namespace cargobay::rt
