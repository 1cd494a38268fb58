// Follows the wall on its right by the wall signal. Without a port: around a virtual pen.
#include <algorithm>
#include <cstdio>
#include <numbers>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> follow(cargobay::Robot& robot) {
  std::chrono::nanoseconds corner_until{0};
  int frames_at_wall = 0;
  // The loop does not stream the wall signal for itself.
  if (auto started = robot.start(); !started) return started;
  if (auto told = robot.subscribe(cargobay::Packet::wall_signal); !told) return told;
  auto states = robot.states(1s);
  for (const cargobay::State& state : states) {
    const auto signal = robot.reading(cargobay::Packet::wall_signal);
    if (!signal) return cargobay::Unexpected{signal.error()};
    // The sensor looks to the right, so the bumper is what finds a corner.
    if (state.bumps) corner_until = state.robot_time + 700ms;
    const double turn_rad_s = std::clamp(0.0007 * (signal->value - 2000), -1.0, 1.0);
    const bool corner = state.robot_time < corner_until;
    auto set = corner ? robot.drive(0.0, 1.5) : robot.drive(150.0, turn_rad_s);
    if (!set) return set;
    frames_at_wall += signal->value > 500 ? 1 : 0;
    if (state.robot_time < 1min) continue;
    std::printf("%.1f m, %.0f %% of the time at a wall, %.1f rounds\n", 1e-3 * state.distance_mm,
                100.0 * frames_at_wall / static_cast<double>(state.tick),
                state.heading_rad / (2.0 * std::numbers::pi));
    return robot.end();
  }
  return states.outcome();
}

int main(int argc, char** argv) {
  auto pen = cargobay::Sim::open(
      {.time = cargobay::SimTime::virtual_time, .world = CARGOBAY_EXAMPLES "/worlds/pen.world"});
  auto robot = argc > 1 ? cargobay::Robot::open({.port = argv[1]})
               : pen    ? cargobay::Robot::open({.sim = &*pen})
                        : cargobay::Unexpected{pen.error()};
  const auto done = robot ? follow(*robot) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
