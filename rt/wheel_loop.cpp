#include "rt/wheel_loop.hpp"

#include <cmath>

namespace cargobay::rt {
namespace {

constexpr double kMoving = 1.0;  // mm/s: a wheel asked for more counts as moving

}  // namespace

WheelLoop::WheelLoop(const Parameters& parameters)
    : parameters_{parameters},
      estimator_{parameters.estimator},
      schedule_{parameters.schedule},
      left_{SlewLimiter{parameters.limits}, VelocityController{parameters.controller}},
      right_{SlewLimiter{parameters.limits}, VelocityController{parameters.controller}} {}

void WheelLoop::lost(int ticks, bool may_have_read) CARGOBAY_NONBLOCKING {
  constexpr int kMostSteps = 100;  // longer than any silence the cycle survives
  for (int i = 0; i < ticks && i < kMostSteps; ++i) estimator_.step_lost(command_, may_have_read);
}

void WheelLoop::frame(const std::optional<WheelEstimator::Reading>& reading) CARGOBAY_NONBLOCKING {
  estimator_.step(command_, reading);
}

double WheelLoop::Wheel::step(double target_mm_s, double estimate_mm_s, Steering steering,
                              const Parameters& parameters) CARGOBAY_NONBLOCKING {
  const double former_mm_s = slew.speed_mm_s();
  const double tick_s = parameters.controller.tick_s;
  const double set_mm_s =
      steering == Steering::nobody ? slew.brake(tick_s) : slew.step(target_mm_s, tick_s);
  // What the integral learnt in one direction is wrong in the other.
  if (set_mm_s == 0.0 || set_mm_s * former_mm_s < 0.0) controller.reset();
  if (set_mm_s == 0.0) return 0.0;
  const double command_mm_s = parameters.feedback == Feedback::open
                                  ? set_mm_s
                                  : controller.step(set_mm_s, slew.rate_mm_s2(), estimate_mm_s);
  return static_cast<double>(std::lrint(command_mm_s));
}

WheelSpeeds WheelLoop::step(const WheelSpeeds& target, Steering steering) CARGOBAY_NONBLOCKING {
  const WheelSpeeds now = estimate();
  command_ = {left_.step(target.left_mm_s, now.left_mm_s, steering, parameters_),
              right_.step(target.right_mm_s, now.right_mm_s, steering, parameters_)};
  return command_;
}

void WheelLoop::stop() CARGOBAY_NONBLOCKING {
  command_ = {};
  for (Wheel* wheel : {&left_, &right_}) {
    wheel->slew.reset(0.0);
    wheel->controller.reset();
  }
  estimator_.doubt_command();
}

bool WheelLoop::next_reads() CARGOBAY_NONBLOCKING {
  using Motion = ReadSchedule::Motion;
  const bool moving =
      std::abs(command_.left_mm_s) > kMoving || std::abs(command_.right_mm_s) > kMoving;
  const bool changing = left_.slew.rate_mm_s2() != 0.0 || right_.slew.rate_mm_s2() != 0.0;
  return schedule_.next_reads(belief(), !moving    ? Motion::none
                                        : changing ? Motion::changing
                                                   : Motion::steady);
}

}  // namespace cargobay::rt
