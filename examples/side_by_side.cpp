// A logger, a display and a safety monitor read events side by side; each sees them all.
#include <cstdio>
#include <thread>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static void read_events(cargobay::Robot& robot, const char* name, bool ends_at_bump) {
  // What was seen is this reader's own affair: nothing is taken from the others.
  auto events = robot.events();
  std::int64_t tick = -1;
  for (bool goes_on = true; goes_on;) {
    const auto state = robot.wait(tick, -1s);
    goes_on = static_cast<bool>(state);
    if (state) tick = state->tick;
    for (const cargobay::Event& event : events) {
      std::printf("%s: %lld %s\n", name, static_cast<long long>(event.sequence),
                  std::string{event_name(event.kind)}.c_str());
      const bool bump = event.kind == cargobay::EventKind::bump_began;
      if (bump && ends_at_bump) (void)robot.request_end();  // it is open
    }
  }
}

static cargobay::Expected<void> drive_until_bump(cargobay::Robot& robot) {
  if (auto started = robot.start(); !started) return started;
  if (auto set = robot.drive(200.0, 0.0); !set) return set;  // once: it lapses, an event
  std::jthread logger{[&] { read_events(robot, "logger", false); }};
  std::jthread display{[&] { read_events(robot, "display", false); }};
  read_events(robot, "safety monitor", true);
  return robot.end();
}

int main(int argc, char** argv) {
  // Without a port: a virtual Create that is bumped into after two seconds.
  auto sim = cargobay::Sim::open();
  const auto bump = sim ? sim->inject("at 2 bump left") : cargobay::Unexpected{sim.error()};
  auto robot = argc > 1 ? cargobay::Robot::open({.port = argv[1]})
               : bump   ? cargobay::Robot::open({.sim = &*sim})
                        : cargobay::Unexpected{bump.error()};
  const auto done = robot ? drive_until_bump(*robot) : cargobay::Unexpected{robot.error()};
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
