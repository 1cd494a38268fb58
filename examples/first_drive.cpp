// Drives ahead for two seconds and prints how fast the wheels turn.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> drive_ahead(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return robot.error();
  if (auto started = robot->start(); !started) return started;
  cargobay::State state{};
  while (std::chrono::nanoseconds{state.time_ns} < 2s) {
    // With every frame: a setpoint lapses after half a second unless renewed.
    if (auto set = robot->drive(200.0, 0.0); !set) return set;
    const auto next = robot->wait(1s);
    if (!next) return next.error();
    state = *next;
  }
  std::printf("the wheels turn at %.1f and %.1f mm/s, the robot is %.0f mm ahead\n",
              state.estimate.left_mm_s, state.estimate.right_mm_s, state.x_mm);
  return robot->stop();
}

int main(int argc, char** argv) {
  // Without a port: a virtual Create, whatever a configuration file says.
  const auto done = drive_ahead(argc > 1 ? cargobay::Options{.port = argv[1]}
                                         : cargobay::Options{.flags = CARGOBAY_NO_CONFIG});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
