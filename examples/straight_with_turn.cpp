// As fast as it goes, straight and then in a curve. Without a port: in virtual time.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> drive_for(std::chrono::nanoseconds duration, cargobay::Twist twist,
                                          cargobay::Robot& robot) {
  auto states = robot.states(1s);
  std::optional<std::chrono::nanoseconds> end;
  for (const cargobay::State& state : states) {
    if (!end) end = state.robot_time + duration;
    if (auto set = robot.drive(twist); !set) return set;
    if (state.robot_time < *end) continue;
    // No wheel goes faster than 500 mm/s: both numbers are scaled down, and the radius stays.
    std::printf("wanted %.0f mm/s, %.2f rad/s: wheels at %.0f and %.0f, %.0f mm/s, %.2f rad/s\n",
                twist.velocity_mm_s, twist.turn_rate_rad_s, state.target.left_mm_s,
                state.target.right_mm_s, state.velocity_mm_s, state.turn_rate_rad_s);
    break;
  }
  return states.outcome();
}

static cargobay::Expected<void> drive(cargobay::Robot& robot) {
  if (auto started = robot.start(); !started) return started;
  if (auto straight = drive_for(2s, {500.0, 0.0}, robot); !straight) return straight;
  if (auto curve = drive_for(2s, {500.0, 0.5}, robot); !curve) return curve;
  return robot.end();
}

int main(int argc, char** argv) {
  auto fast = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  auto robot = argc > 1 ? cargobay::Robot::open({.port = argv[1]})
               : fast   ? cargobay::Robot::open({.sim = &*fast})
                        : cargobay::Unexpected{fast.error()};
  const auto done = robot ? drive(*robot) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
