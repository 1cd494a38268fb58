// Several virtual Creates in one world, in C++.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "hal/c/cargobay.hpp"

namespace {

using namespace std::chrono_literals;
using cargobay::ErrorCode;

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n  last error: %s\n", what, cargobay_error_message());
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

void meet() {
  auto first = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  auto second = cargobay::Sim::open({.beside = &*first});
  check(first && second, "both open");
  check(second->inject("place 600 0 180").has_value(), "in the way");
  auto robot = cargobay::Robot::open({.sim = &*first});
  auto other = cargobay::Robot::open({.sim = &*second});
  check(robot && other && robot->start() && other->start(), "both start");
  cargobay::State state{.tick = -1};
  while (state.bumps == cargobay::Bumps{}) {
    const auto next = robot->wait(state.tick, 1s);
    check(next && robot->drive(200.0, 0.0), "drives");
    state = *next;
  }
  check(std::abs(first->truth()->x_mm - 270.0) < 10.0, "where they meet");
  check(first->truth()->sim_time == second->truth()->sim_time, "one clock");
  check(other->state()->tick > 50, "its loop has run meanwhile");
  check(first->close().error().code == ErrorCode::state, "the first one is closed last");
}

void is_refused() {
  auto first = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  check(first && first->close(), "closed");
  const auto beside_closed = cargobay::Sim::open({.beside = &*first});
  check(!beside_closed && beside_closed.error().code == ErrorCode::handle,
        "beside one that is closed");
}

}  // namespace

int main() {
  meet();
  is_refused();
}
