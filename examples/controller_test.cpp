// A unit test of a controller: a minute of robot time on a virtual Create, in a moment.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// Under test: drives 1 m ahead, keeps its heading, stops.
static cargobay::Wheels one_metre(const cargobay::State& state) {
  const double velocity_mm_s = std::clamp(2.0 * (1000.0 - state.x_mm), -200.0, 200.0);
  return cargobay::wheels_of(velocity_mm_s, -2.0 * state.heading_rad);
}

// The true pose after a minute.
static cargobay::Expected<cargobay::Truth> run() {
  auto create = cargobay::VirtualCreate::open({.time = CARGOBAY_SIM_VIRTUAL});
  if (!create) return create.error();
  auto robot = cargobay::Robot::open({.flags = CARGOBAY_NO_CONFIG, .sim = &*create});
  if (!robot) return robot.error();
  if (auto set = robot->control(one_metre); !set) return set.error();
  if (auto started = robot->start(); !started) return started.error();
  for (std::chrono::nanoseconds now{0}; now < 1min;) {
    const auto state = robot->wait(1s);
    if (!state) return state.error();
    now = std::chrono::nanoseconds{state->time_ns};
  }
  return create->truth();
}

static int check(bool holds, const char* what) {
  std::printf("%s: %s\n", what, holds ? "ok" : "FAILED");
  return holds ? 0 : 1;
}

int main() {
  const auto began = std::chrono::steady_clock::now();
  const auto truth = run();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  if (!truth) std::fprintf(stderr, "%s\n", truth.error().message);
  if (!truth) return 1;
  std::printf("%.0f times as fast as the robot\n", 1min / took);
  const double speed_mm_s = std::abs(truth->left_mm_s) + std::abs(truth->right_mm_s);
  return check(std::abs(truth->x_mm - 1000.0) < 20.0, "it is 1 m ahead") +
         check(std::abs(truth->y_mm) < 50.0, "it is not far to the side") +
         check(speed_mm_s < 5.0, "it has stopped");
}
