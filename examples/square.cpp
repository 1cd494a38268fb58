// A 500 mm square by odometry, and where the robot ends up. Without a port: in virtual time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <cargobay.hpp>

// Drives until the robot has gone this far in total and has this heading.
static cargobay::Expected<void> go_to(cargobay::Robot& robot, double distance_mm,
                                      double heading_rad) {
  for (;;) {
    const auto state = robot.wait(std::chrono::seconds{1});
    if (!state) return state.error();
    const double ahead_mm = distance_mm - state->distance_mm;
    const double turn_rad = heading_rad - state->heading_rad;
    if (std::abs(ahead_mm) < 5.0 && std::abs(turn_rad) < 0.03) return {};
    const double velocity_mm_s = std::clamp(4.0 * ahead_mm, -250.0, 250.0);
    auto set = robot.drive(velocity_mm_s, std::clamp(4.0 * turn_rad, -1.5, 1.5));
    if (!set) return set;
  }
}

static cargobay::Expected<void> drive_square(const char* port) {
  auto fast = cargobay::VirtualCreate::open({.time = CARGOBAY_SIM_VIRTUAL});
  if (!fast) return fast.error();
  auto robot = cargobay::Robot::open(port != nullptr ? cargobay::Options{.port = port}
                                                     : cargobay::Options{.sim = &*fast});
  if (!robot) return robot.error();
  if (auto started = robot->start(); !started) return started;
  constexpr double corner_rad = std::numbers::pi / 2.0;
  for (int side = 0; side < 4; ++side) {
    if (auto done = go_to(*robot, 500.0 * (side + 1), corner_rad * side); !done) return done;
    if (auto done = go_to(*robot, 500.0 * (side + 1), corner_rad * (side + 1)); !done) return done;
  }
  const auto end = robot->state();
  if (!end) return end.error();
  std::printf("back at %.0f, %.0f mm after %.0f mm\n", end->x_mm, end->y_mm, end->distance_mm);
  return robot->stop();
}

int main(int argc, char** argv) {
  const auto done = drive_square(argc > 1 ? argv[1] : nullptr);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
