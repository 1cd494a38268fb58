// Turns away from what it bumps into, as the events report. Without a port: in a virtual pen.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> wander(const char* port) {
  auto pen = cargobay::VirtualCreate::open(
      {.time = CARGOBAY_SIM_VIRTUAL, .world = CARGOBAY_EXAMPLES "/worlds/pen.world"});
  if (!pen) return pen.error();
  auto robot = cargobay::Robot::open(port != nullptr ? cargobay::Options{.port = port}
                                                     : cargobay::Options{.sim = &*pen});
  if (!robot) return robot.error();
  if (auto started = robot->start(); !started) return started;
  std::chrono::nanoseconds now{0};
  std::chrono::nanoseconds turn_until{0};
  double turn_rad_s = 0.0;
  int bumps = 0;
  while (now < 1min) {
    const auto state = robot->wait(1s);
    if (!state) return state.error();
    now = std::chrono::nanoseconds{state->time_ns};
    while (const auto event = robot->next_event()) {
      if (event->kind != CARGOBAY_EVENT_BUMP_BEGAN) continue;
      ++bumps;
      turn_rad_s = event->bumps == CARGOBAY_BUMP_LEFT ? -1.5 : 1.5;
      turn_until = now + 1100ms;
    }
    auto set = now < turn_until ? robot->drive(0.0, turn_rad_s) : robot->drive(200.0, 0.0);
    if (!set) return set;
  }
  std::printf("%d bumps in a minute\n", bumps);
  return robot->stop();
}

int main(int argc, char** argv) {
  const auto done = wander(argc > 1 ? argv[1] : nullptr);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
