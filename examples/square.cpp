// A 500 mm square by odometry, and where the robot ends up. Without a port: in virtual time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <cargobay.hpp>

// Drives until the robot has gone this far in total and has this heading.
static cargobay::Expected<void> go_to(cargobay::Robot& robot, double distance_mm,
                                      double heading_rad) {
  auto states = robot.states(std::chrono::seconds{1});
  for (const cargobay::State& state : states) {
    const double ahead_mm = distance_mm - state.distance_mm;
    const double turn_rad = heading_rad - state.heading_rad;
    if (std::abs(ahead_mm) < 5.0 && std::abs(turn_rad) < 0.03) break;
    const double velocity_mm_s = std::clamp(4.0 * ahead_mm, -250.0, 250.0);
    auto set = robot.drive(velocity_mm_s, std::clamp(4.0 * turn_rad, -1.5, 1.5));
    if (!set) return set;
  }
  return states.outcome();
}

static cargobay::Expected<void> drive_square(cargobay::Robot& robot) {
  if (auto started = robot.start(); !started) return started;
  constexpr double corner_rad = std::numbers::pi / 2.0;
  for (int side = 0; side < 4; ++side) {
    if (auto done = go_to(robot, 500.0 * (side + 1), corner_rad * side); !done) return done;
    if (auto done = go_to(robot, 500.0 * (side + 1), corner_rad * (side + 1)); !done) return done;
  }
  const auto end = robot.state();
  if (!end) return cargobay::Unexpected{end.error()};
  std::printf("back at %.0f, %.0f mm after %.0f mm\n", end->x_mm, end->y_mm, end->distance_mm);
  return robot.end();
}

int main(int argc, char** argv) {
  auto fast = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  auto robot = argc > 1 ? cargobay::Robot::open({.port = argv[1]})
               : fast   ? cargobay::Robot::open({.sim = &*fast})
                        : cargobay::Unexpected{fast.error()};
  const auto done = robot ? drive_square(*robot) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
