// A controller that others watch while it drives a figure of eight: run `cargobay top` beside it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include <cargobay.hpp>

static cargobay::Expected<void> drive_eights(cargobay::Robot& robot, std::chrono::seconds for_s) {
  if (auto started = robot.start(); !started) return started;
  constexpr double eight_s = 8.0;  // a full figure
  auto states = robot.states(std::chrono::seconds{1});
  for (const cargobay::State& state : states) {
    if (state.robot_time >= for_s) break;
    const double time_s = std::chrono::duration<double>{state.robot_time}.count();
    const double side = std::fmod(time_s / eight_s, 1.0) < 0.5 ? 1.0 : -1.0;
    auto set = robot.drive(150.0, side * 4.0 * std::numbers::pi / eight_s);
    if (!set) return set;
  }
  if (auto outcome = states.outcome(); !outcome) return outcome;
  return robot.end();
}

int main(int argc, char** argv) {
  const std::chrono::seconds for_s{argc > 2 ? std::strtol(argv[2], nullptr, 10) : 2};
  // This flag is all that it takes.
  cargobay::Options options{.flags = cargobay::Flag::publish};
  if (argc > 1)
    options.port = argv[1];
  else
    options.flags |= cargobay::Flag::no_config;  // a virtual Create
  auto robot = cargobay::Robot::open(options);
  const auto done = robot ? drive_eights(*robot, for_s) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
