#include "hal/sim/wheels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

// Below this speed a wheel whose command is 0 stops; an exponential never would.
constexpr double kStandsBelowMmPerSec = 1e-6;
// The pose is integrated by quadrature in steps no longer than this; its error is then below
// 1e-9 mm per step for any lag that moves a robot.
constexpr double kLongestStepS = 0.015;

}  // namespace

Wheel::Wheel(const WheelParameters& parameters, double droop)
    : lag_s_{parameters.lag_s},
      gain_{1.0 - droop},
      dead_band_mm_s_{parameters.dead_band_mm_s},
      counts_per_mm_{parameters.counts_per_mm} {}

void Wheel::set_command(double command_mm_s) {
  command_mm_s_ = command_mm_s;
  if (command_mm_s > 0.0) direction_ = 1;
  if (command_mm_s < 0.0) direction_ = -1;
  if (command_mm_s == 0.0 && turned_mm_s_ != 0.0) direction_ = 1;
}

void Wheel::set_turned(double turned_mm_s) {
  turned_mm_s_ = turned_mm_s;
  if (command_mm_s_ == 0.0 && turned_mm_s != 0.0) direction_ = 1;
}

void Wheel::set_disturbance(double disturbance_mm_s) { disturbance_mm_s_ = disturbance_mm_s; }

void Wheel::set_blocked(bool blocked) {
  blocked_ = blocked;
  if (blocked) speed_mm_s_ = 0.0;
}

bool Wheel::motor_on() const {
  return std::abs(command_mm_s_) >= dead_band_mm_s_ && command_mm_s_ != 0.0;
}

double Wheel::driven_mm_s() const {
  if (!motor_on()) return turned_mm_s_;
  return gain_ * command_mm_s_ + disturbance_mm_s_;
}

double Wheel::speed_after(double period_s) const {
  if (blocked_ || period_s <= 0.0) return speed_mm_s_;
  const double driven = driven_mm_s();
  return driven + (speed_mm_s_ - driven) * std::exp(-period_s / lag_s_);
}

double Wheel::travel_after(double period_s) const {
  if (blocked_ || period_s <= 0.0) return travel_mm_;
  const double driven = driven_mm_s();
  return travel_mm_ + driven * period_s -
         (speed_mm_s_ - driven) * lag_s_ * std::expm1(-period_s / lag_s_);
}

// Forward and back over the same edge are two counts, so a change of direction ends a piece.
void Wheel::advance(double period_s) {
  const double driven = driven_mm_s();
  if (speed_mm_s_ * driven < 0.0) {
    const double until_reversal_s = lag_s_ * std::log1p(-speed_mm_s_ / driven);
    if (until_reversal_s < period_s) {
      advance_one_way(until_reversal_s);
      speed_mm_s_ = 0.0;
      period_s -= until_reversal_s;
    }
  }
  advance_one_way(period_s);
}

void Wheel::advance_one_way(double period_s) {
  const double travel = travel_after(period_s);
  const auto passed = static_cast<std::int64_t>(std::floor(travel * counts_per_mm_) -
                                                std::floor(travel_mm_ * counts_per_mm_));
  edges_ += std::abs(passed);
  counts_ += direction_ * std::abs(passed);
  speed_mm_s_ = speed_after(period_s);
  travel_mm_ = travel;
  if (std::abs(speed_mm_s_) < kStandsBelowMmPerSec && driven_mm_s() == 0.0) speed_mm_s_ = 0.0;
}

Wheels::Wheels(const Parameters& parameters)
    : left_{parameters.wheels, parameters.wheels.droop_left},
      right_{parameters.wheels, parameters.wheels.droop_right},
      wheel_base_mm_{parameters.wheels.wheel_base_mm},
      noise_mm_s_{parameters.wheels.noise_mm_s},
      noise_keep_{std::exp(-rt::seconds(oi::kTick) / parameters.wheels.noise_lag_s)},
      random_{parameters.seed} {}

void Wheels::set_command(WheelSpeeds command) {
  command_ = command;
  left_.set_command(command.left_mm_s);
  right_.set_command(command.right_mm_s);
}

void Wheels::set_blocked(bool left, bool right) {
  left_.set_blocked(left);
  right_.set_blocked(right);
}

void Wheels::set_turned(WheelSpeeds turned) {
  turned_ = turned;
  left_.set_turned(turned.left_mm_s);
  right_.set_turned(turned.right_mm_s);
}

void Wheels::advance(rt::Duration period) {
  const bool stands =
      speeds() == WheelSpeeds{} && command_ == WheelSpeeds{} && turned_ == WheelSpeeds{};
  if (stands) return;
  double left_over_s = rt::seconds(period);
  while (left_over_s > 0.0) {
    const double period_s = std::min(left_over_s, kLongestStepS);
    step(period_s);
    left_over_s -= period_s;
  }
}

// Speed and heading are known in closed form at every instant of the step; the path along them is
// not, and is integrated with three-point Gauss-Legendre quadrature.
void Wheels::step(double period_s) {
  struct Point {
    double place;
    double weight;
  };
  constexpr double kOuter = 0.3872983346207417;  // sqrt(0.15)
  constexpr std::array<Point, 3> kPoints{
      {{0.5 - kOuter, 5.0 / 18.0}, {0.5, 8.0 / 18.0}, {0.5 + kOuter, 5.0 / 18.0}}};
  const double left_mm = left_.travel_mm();
  const double right_mm = right_.travel_mm();
  const double heading_rad = pose_.heading_rad;
  for (const Point& point : kPoints) {
    const double time_s = point.place * period_s;
    const double turned_mm =
        (right_.travel_after(time_s) - right_mm) - (left_.travel_after(time_s) - left_mm);
    const double heading_then_rad = heading_rad + turned_mm / wheel_base_mm_;
    const double speed_mm_s = 0.5 * (left_.speed_after(time_s) + right_.speed_after(time_s));
    pose_.x_mm += point.weight * period_s * speed_mm_s * std::cos(heading_then_rad);
    pose_.y_mm += point.weight * period_s * speed_mm_s * std::sin(heading_then_rad);
  }
  left_.advance(period_s);
  right_.advance(period_s);
  pose_.heading_rad +=
      ((right_.travel_mm() - right_mm) - (left_.travel_mm() - left_mm)) / wheel_base_mm_;
}

void Wheels::tick() {
  if (noise_mm_s_ == 0.0) return;
  const double fresh = std::sqrt(1.0 - noise_keep_ * noise_keep_);
  left_noise_ = noise_keep_ * left_noise_ + fresh * random_.normal();
  right_noise_ = noise_keep_ * right_noise_ + fresh * random_.normal();
  left_.set_disturbance(noise_mm_s_ * left_noise_);
  right_.set_disturbance(noise_mm_s_ * right_noise_);
}

}  // namespace cargobay::hal::sim
