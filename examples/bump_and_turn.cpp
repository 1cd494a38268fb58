// Turns away from what it bumps into, as the events report. Without a port: in a virtual pen.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> wander(cargobay::Robot& robot) {
  std::chrono::nanoseconds turn_until{0};
  double turn_rad_s = 0.0;
  int bumps = 0;
  if (auto started = robot.start(); !started) return started;
  auto states = robot.states(1s);
  auto events = robot.events();
  for (const cargobay::State& state : states) {
    for (const cargobay::Event& event : events) {
      if (event.kind != cargobay::EventKind::bump_began) continue;
      ++bumps;
      turn_rad_s = event.bumps == cargobay::Bump::left ? -1.5 : 1.5;
      turn_until = state.robot_time + 1100ms;
    }
    const bool turns = state.robot_time < turn_until;
    auto set = turns ? robot.drive(0.0, turn_rad_s) : robot.drive(200.0, 0.0);
    if (!set) return set;
    if (state.robot_time < 1min) continue;
    std::printf("%d bumps in a minute\n", bumps);
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
  const auto done = robot ? wander(*robot) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
