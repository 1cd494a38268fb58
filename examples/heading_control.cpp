// Your own controller: a PID on the heading, called by the loop once a frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <cargobay.hpp>

struct Pid {
  double heading_rad;  // wanted
  double integral_rad_s = 0.0;
  std::int64_t time_ns = 0;  // of the previous frame

  // Runs on the control thread: no lock, no printf, nothing that waits.
  cargobay::Wheels operator()(const cargobay::State& state) {
    const double error_rad = heading_rad - state.heading_rad;
    const double period_s = 1e-9 * static_cast<double>(state.time_ns - time_ns);
    time_ns = state.time_ns;
    // Only near the goal: what adds up on the way there would be overshoot.
    if (std::abs(error_rad) < 0.2) integral_rad_s += error_rad * period_s;
    const double rate = 3.0 * error_rad + 0.5 * integral_rad_s - 0.2 * state.turn_rate_rad_s;
    return cargobay::wheels_of(150.0, std::clamp(rate, -1.5, 1.5));
  }
};

static cargobay::Expected<void> turn_left(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return robot.error();
  if (auto set = robot->control(Pid{.heading_rad = std::numbers::pi / 2.0}); !set) return set;
  if (auto started = robot->start(); !started) return started;
  cargobay::Expected<cargobay::State> state = cargobay::State{};
  while (state && state->time_ns < 4'000'000'000) state = robot->wait(std::chrono::seconds{1});
  if (!state) return state.error();
  std::printf("wanted %.3f rad, the heading is %.3f rad\n", std::numbers::pi / 2.0,
              state->heading_rad);
  return robot->stop();
}

int main(int argc, char** argv) {
  const auto done = turn_left(argc > 1 ? cargobay::Options{.port = argv[1]}
                                       : cargobay::Options{.flags = CARGOBAY_NO_CONFIG});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
