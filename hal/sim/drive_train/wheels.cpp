#include "hal/sim/drive_train/wheels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

// The pose is integrated by quadrature in steps no longer than this; its error is then below
// 1e-9 mm per step for any lag that moves a robot.
constexpr double kLongestStepS = 0.015;

rt::Duration duration(double seconds) { return rt::Duration{std::llround(seconds * 1e9)}; }

// Never, if no controller counts.
rt::Duration inner_period(const WheelParameters& parameters) {
  return parameters.response == Response::counting ? duration(parameters.inner_period_s)
                                                   : rt::Duration::max();
}

double noise_keep(const WheelParameters& parameters) {
  return std::exp(-rt::seconds(oi::kTick) / parameters.noise_lag_s);
}

}  // namespace

Wheels::Wheels(const Parameters& parameters)
    : left_{parameters.wheels, Side::left},
      right_{parameters.wheels, Side::right},
      dead_time_{duration(parameters.wheels.dead_time_s)},
      inner_period_{inner_period(parameters.wheels)},
      wheel_base_mm_{parameters.wheels.wheel_base_mm},
      noise_mm_s_{parameters.wheels.noise_mm_s},
      noise_keep_{noise_keep(parameters.wheels)},
      random_{parameters.seed} {}

void Wheels::set(const WheelParameters& parameters) {
  left_.set(parameters);
  right_.set(parameters);
  dead_time_ = duration(parameters.dead_time_s);
  inner_period_ = inner_period(parameters);
  wheel_base_mm_ = parameters.wheel_base_mm;
  noise_mm_s_ = parameters.noise_mm_s;
  noise_keep_ = noise_keep(parameters);
  if (noise_mm_s_ != 0.0) return;
  left_.set_disturbance(0.0);
  right_.set_disturbance(0.0);
}

WheelSpeeds Wheels::speeds() const {
  return {left_.speed_mm_s() * left_.grip(), right_.speed_mm_s() * right_.grip()};
}

void Wheels::set_command(WheelSpeeds command) {
  command_ = command;
  if (dead_time_ == rt::Duration::zero() && delay_.empty()) return tell(command);
  delay_.push(command, now_ + dead_time_);
}

void Wheels::tell(WheelSpeeds command) {
  left_.set_command(command.left_mm_s);
  right_.set_command(command.right_mm_s);
}

void Wheels::set_blocked(bool left, bool right) {
  left_.set_blocked(left);
  right_.set_blocked(right);
}

void Wheels::set_turned(WheelSpeeds turned) {
  left_.set_turned(turned.left_mm_s);
  right_.set_turned(turned.right_mm_s);
}

void Wheels::set_load(double left, double right) {
  left_.set_load(left);
  right_.set_load(right);
}

void Wheels::advance(rt::Duration period) {
  const rt::Duration end = now_ + period;
  while (delay_.due() <= end) {
    pass(delay_.due() - now_);
    tell(delay_.pop());
  }
  pass(end - now_);
}

// Without a command: from one tick of the controller inside the robot to the next.
void Wheels::pass(rt::Duration period) {
  const rt::Duration end = now_ + period;
  while (inner_period_ != rt::Duration::max() && !rests()) {
    const rt::Duration next = (now_ / inner_period_ + 1) * inner_period_;
    if (next > end) break;
    glide(next - now_);
    now_ = next;
    left_.tick();
    right_.tick();
  }
  glide(end - now_);
  now_ = end;
}

void Wheels::glide(rt::Duration period) {
  if (rests()) return;
  double left_over_s = rt::seconds(period);
  while (left_over_s > 0.0) {
    double period_s = std::min(left_over_s, kLongestStepS);
    period_s = left_.until_change_s(period_s);
    period_s = right_.until_change_s(period_s);
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
  const auto turned_mm = [&](double left_to_mm, double right_to_mm) {
    return (right_to_mm - right_mm) * right_.grip() - (left_to_mm - left_mm) * left_.grip();
  };
  for (const Point& point : kPoints) {
    const double time_s = point.place * period_s;
    const double heading_then_rad =
        heading_rad +
        turned_mm(left_.travel_after(time_s), right_.travel_after(time_s)) / wheel_base_mm_;
    const double speed_mm_s = 0.5 * (left_.speed_after(time_s) * left_.grip() +
                                     right_.speed_after(time_s) * right_.grip());
    pose_.x_mm += point.weight * period_s * speed_mm_s * std::cos(heading_then_rad);
    pose_.y_mm += point.weight * period_s * speed_mm_s * std::sin(heading_then_rad);
  }
  left_.advance(period_s);
  right_.advance(period_s);
  pose_.heading_rad += turned_mm(left_.travel_mm(), right_.travel_mm()) / wheel_base_mm_;
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
