// A unit test of a controller: a minute of robot time on a virtual Create, in a moment.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// Under test: drives 1 m ahead, keeps its heading, stops.
static cargobay::Twist one_metre(const cargobay::State& state) {
  return {.velocity_mm_s = std::clamp(2.0 * (1000.0 - state.x_mm), -200.0, 200.0),
          .turn_rate_rad_s = -2.0 * state.heading_rad};
}

// The true pose after a minute.
static cargobay::Expected<cargobay::Truth> run() {
  auto sim = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  if (!sim) return cargobay::Unexpected{sim.error()};
  auto robot = cargobay::Robot::open({.sim = &*sim});
  if (!robot) return cargobay::Unexpected{robot.error()};
  if (auto set = robot->set_control(one_metre); !set) return cargobay::Unexpected{set.error()};
  if (auto started = robot->start(); !started) return cargobay::Unexpected{started.error()};
  auto states = robot->states(1s);
  for (const cargobay::State& state : states) {
    if (state.robot_time >= 1min) return sim->truth();
  }
  return cargobay::Unexpected{states.outcome().error()};
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
