// Two robots in one world, in virtual time: the second catches up until its bumper touches.
#include <array>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> catch_up(std::array<cargobay::Robot*, 2> robots) {
  const std::array velocities{80.0, 200.0};
  std::array states{cargobay::State{.tick = -1}, cargobay::State{.tick = -1}};
  for (cargobay::Robot* const robot : robots) {
    if (auto started = robot->start(); !started) return started;
  }
  while (states[1].bumps == cargobay::Bumps{}) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto next = robots[i]->wait(states[i].tick, 1s);
      if (!next) return next.outcome();
      states[i] = *next;
      if (auto set = robots[i]->drive(velocities[i], 0.0); !set) return set;
    }
  }
  std::printf("caught up after %.0f mm\n", states[1].x_mm);
  return {};
}

static cargobay::Expected<void> run() {
  auto ahead = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  if (!ahead) return cargobay::Unexpected{ahead.error()};
  auto behind = cargobay::Sim::open({.beside = &*ahead});  // its world, its clock
  if (!behind) return cargobay::Unexpected{behind.error()};
  const auto placed = behind->inject("place -800 0 0");
  if (!placed) return cargobay::Unexpected{placed.error()};
  auto first = cargobay::Robot::open({.sim = &*ahead});
  if (!first) return cargobay::Unexpected{first.error()};
  auto second = cargobay::Robot::open({.sim = &*behind});
  if (!second) return cargobay::Unexpected{second.error()};
  return catch_up({&*first, &*second});
}

int main() {
  const auto done = run();
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
