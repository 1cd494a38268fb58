// By hand, by a controller, by hand again: the odometry goes on. Without a port: in virtual time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// By hand: the setpoint is renewed with every frame.
static cargobay::Expected<void> drive_ahead(cargobay::Robot& robot) {
  auto states = robot.states(1s);
  std::optional<std::chrono::nanoseconds> end;
  for (const cargobay::State& state : states) {
    if (!end) end = state.robot_time + 3s;
    if (auto set = robot.drive(200.0, 0.0); !set) return set;
    if (state.robot_time < *end) continue;
    std::printf("at %.0f, %.0f mm after %.0f mm\n", state.x_mm, state.y_mm, state.distance_mm);
    break;
  }
  return states.outcome();
}

static cargobay::Expected<void> turn_about(cargobay::Robot& robot) {
  auto set = robot.set_control([](const cargobay::State& state) {
    const double left_rad = std::numbers::pi - state.heading_rad;
    return cargobay::Twist{.turn_rate_rad_s = std::min(1.5, 4.0 * left_rad)};
  });
  if (!set) return set;
  auto states = robot.states(1s);
  for (const cargobay::State& state : states) {
    if (std::abs(std::numbers::pi - state.heading_rad) < 0.02) break;
  }
  return states.outcome() ? robot.set_control(nullptr) : states.outcome();
}

static cargobay::Expected<void> there_and_back(cargobay::Robot& robot) {
  if (auto started = robot.start(); !started) return started;
  if (auto there = drive_ahead(robot); !there) return there;
  if (auto turned = turn_about(robot); !turned) return turned;
  if (auto back = drive_ahead(robot); !back) return back;
  return robot.end();
}

int main(int argc, char** argv) {
  auto fast = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  auto robot = argc > 1 ? cargobay::Robot::open({.port = argv[1]})
               : fast   ? cargobay::Robot::open({.sim = &*fast})
                        : cargobay::Unexpected{fast.error()};
  const auto done = robot ? there_and_back(*robot) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
