// Two robots in one thread: whichever frame comes first is answered first.
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <vector>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// The second robot drives as fast as the first one is seen to drive.
static cargobay::Expected<void> follow(std::vector<cargobay::Robot>& robots) {
  std::array<cargobay::State, 2> states{};
  std::array<pollfd, 2> fds{};
  for (std::size_t i = 0; i < 2; ++i) fds[i] = {robots[i].fd().value_or(-1), POLLIN, 0};
  while (states[0].robot_time < 2s || states[1].robot_time < 2s) {
    (void)poll(fds.data(), 2, -1);  // interrupted: nothing can be read
    for (std::size_t i = 0; i < 2; ++i) {
      std::uint64_t ignored = 0;
      if (read(fds[i].fd, &ignored, sizeof ignored) < 0) continue;  // nothing new
      const auto next = robots[i].wait(states[i].tick, 0s);
      if (next.code() == cargobay::ErrorCode::timeout) continue;  // an event, and no frame
      if (!next) return next.outcome();
      states[i] = *next;
      auto set = robots[i].drive(i == 0 ? 200.0 : states[0].velocity_mm_s, 0.0);
      if (!set) return set;
    }
  }
  std::printf("%.0f and %.0f mm ahead after %lld and %lld frames\n", states[0].x_mm, states[1].x_mm,
              static_cast<long long>(states[0].tick), static_cast<long long>(states[1].tick));
  return {};
}

static cargobay::Expected<void> drive(const std::array<cargobay::Options, 2>& both) {
  std::vector<cargobay::Robot> robots;
  for (const cargobay::Options& options : both) {
    auto robot = cargobay::Robot::open(options);
    if (!robot) return cargobay::Unexpected{robot.error()};
    if (auto started = robot->start(); !started) return started;
    robots.push_back(*std::move(robot));
  }
  return follow(robots);
}

int main(int argc, char** argv) {
  // Without two ports: two virtual Creates.
  const cargobay::Options its_own{.flags = cargobay::Flag::no_config};
  const auto done =
      argc > 2 ? drive({{{.port = argv[1]}, {.port = argv[2]}}}) : drive({its_own, its_own});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
