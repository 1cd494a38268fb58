// A unit test of a controller, on an ideal robot that bumps into something at 3 s.
#include <cmath>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// Under test: drives ahead; backs off for a second from what it bumps into, and waits.
struct BackOff {
  std::optional<std::chrono::nanoseconds> bumped{};

  cargobay::Wheels operator()(const cargobay::State& state) {
    if (!bumped && state.bumps) bumped = state.robot_time;
    if (!bumped) return {200.0, 200.0};
    if (state.robot_time > *bumped + 1s) return {0.0, 0.0};
    return {-100.0, -100.0};
  }
};

// Goes on until the robot's own time is `time`; its wheels must then turn at this speed.
static bool turns(double wanted_mm_s, std::chrono::milliseconds time, cargobay::Robot& robot,
                  cargobay::Sim& sim) {
  auto states = robot.states(1s);
  for (auto state = states.begin(); state != states.end(); ++state) {
    const auto truth = sim.truth();
    if (!truth || truth->sim_time < time) continue;
    const bool holds = std::abs(truth->left_mm_s - wanted_mm_s) < 1.0 &&
                       std::abs(truth->right_mm_s - wanted_mm_s) < 1.0;
    std::printf("%.1f s: %+.1f and %+.1f mm/s: %s\n", std::chrono::duration<double>{time}.count(),
                truth->left_mm_s, truth->right_mm_s, holds ? "ok" : "FAILED");
    return holds;
  }
  return false;
}

int main() {
  auto ideal = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time,
                                    .gain_left = 1.0,
                                    .gain_right = 1.0,
                                    .noise_mm_s = -1.0});
  auto robot = ideal && ideal->inject("at 3 bump left") ? cargobay::Robot::open({.sim = &*ideal})
                                                        : cargobay::Robot::open();
  const bool good = robot && robot->set_control(BackOff{}) && robot->start() &&
                    turns(200.0, 2900ms, *robot, *ideal) && turns(-100.0, 3900ms, *robot, *ideal) &&
                    turns(0.0, 5000ms, *robot, *ideal);
  if (!good) std::fprintf(stderr, "%s\n", cargobay_error_message());
  return good ? 0 : 1;
}
