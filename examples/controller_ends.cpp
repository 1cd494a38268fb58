// A controller that ends by itself after a metre. Without a port: in virtual time.
#include <algorithm>
#include <cstdio>

#include <cargobay.hpp>

// Slows down ahead of the goal, because the loop stops the wheels when this has finished.
static cargobay::Output one_metre(const cargobay::State& state) {
  const double left_mm = 1000.0 - state.distance_mm;
  if (left_mm <= 0.0) return cargobay::Output::finished();
  return cargobay::Twist{.velocity_mm_s = std::clamp(2.0 * left_mm, 20.0, 300.0)};
}

static cargobay::Expected<void> drive(cargobay::Robot& robot) {
  if (auto set = robot.set_control(one_metre); !set) return set;
  if (auto started = robot.start(); !started) return started;
  cargobay::State last;
  auto states = robot.states(std::chrono::seconds{1});
  for (const cargobay::State& state : states) last = state;
  if (auto ended = robot.end(); !ended) return ended;
  const std::chrono::duration<double> took{last.robot_time};
  std::printf("%.0f mm after %.1f s\n", last.distance_mm, took.count());
  return {};
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
