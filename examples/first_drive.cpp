// Drives ahead for two seconds and prints how fast the wheels turn.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> drive_ahead(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return cargobay::Unexpected{robot.error()};
  if (auto started = robot->start(); !started) return started;
  auto states = robot->states(1s);
  for (const cargobay::State& state : states) {
    // With every frame: a setpoint lapses after half a second unless renewed.
    if (auto set = robot->drive(200.0, 0.0); !set) return set;
    if (state.robot_time < 2s) continue;
    std::printf("the wheels turn at %.1f and %.1f mm/s, the robot is %.0f mm ahead\n",
                state.estimate.left_mm_s, state.estimate.right_mm_s, state.x_mm);
    return robot->end();
  }
  return states.outcome();
}

int main(int argc, char** argv) {
  // Without a port: a virtual Create, whatever a configuration file says.
  const auto done = drive_ahead(argc > 1 ? cargobay::Options{.port = argv[1]}
                                         : cargobay::Options{.flags = cargobay::Flag::no_config});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
