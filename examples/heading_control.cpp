// Your own controller: a PID on the heading, called by the loop once a frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <cargobay.hpp>

struct Pid {
  double heading_rad;  // wanted
  double integral_rad_s = 0.0;

  // Runs on the control thread: no lock, no printf, nothing that waits.
  cargobay::Twist operator()(const cargobay::State& state) {
    const double error_rad = heading_rad - state.heading_rad;
    const std::chrono::duration<double> period{state.elapsed};
    // Only near the goal: what adds up on the way there would be overshoot.
    if (std::abs(error_rad) < 0.2) integral_rad_s += error_rad * period.count();
    const double rate = 3.0 * error_rad + 0.5 * integral_rad_s - 0.2 * state.turn_rate_rad_s;
    return {.velocity_mm_s = 150.0, .turn_rate_rad_s = std::clamp(rate, -1.5, 1.5)};
  }
};

static cargobay::Expected<void> turn(double wanted_rad, const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return cargobay::Unexpected{robot.error()};
  if (auto set = robot->set_control(Pid{.heading_rad = wanted_rad}); !set) return set;
  if (auto started = robot->start(); !started) return started;
  auto states = robot->states(std::chrono::seconds{1});
  for (const cargobay::State& state : states) {
    if (state.robot_time < std::chrono::seconds{4}) continue;
    std::printf("wanted %.3f rad, the heading is %.3f rad\n", wanted_rad, state.heading_rad);
    return robot->end();
  }
  return states.outcome();
}

int main(int argc, char** argv) {
  const auto options = argc > 1 ? cargobay::Options{.port = argv[1]}
                                : cargobay::Options{.flags = cargobay::Flag::no_config};
  const auto done = turn(std::numbers::pi / 2.0, options);  // to the left
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
