// A C++ control function that does not return is never freed, neither when the robot is closed nor
// when another function replaces it: its thread is still in it.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hal/c/cargobay.hpp"

namespace {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): the thread's, whenever it comes
std::atomic<bool> inside{false};
std::atomic<bool> let_go{false};
std::atomic<bool> returned{false};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

void check_stalled(const cargobay::Expected<void>& outcome, const char* what) {
  check(!outcome && outcome.error().code == cargobay::ErrorCode::stalled, what);
}

void nap() { std::this_thread::sleep_for(std::chrono::milliseconds{1}); }

cargobay::Robot hung_robot(cargobay::Sim& sim) {
  auto robot =
      cargobay::Robot::open({.flags = cargobay::Flag::no_config, .sim = &sim, .priority = 10});
  check(robot.has_value(), "it opens");
  const auto control = [held = std::vector<std::string>(100, std::string(100, 'x'))](
                           const cargobay::State& state) -> cargobay::Wheels {
    if (state.tick < 30) return {.left_mm_s = 200.0, .right_mm_s = 200.0};
    inside = true;
    while (!let_go) nap();
    const bool whole = held.size() == 100 && held.back() == std::string(100, 'x');
    check(whole, "what it holds is still there");
    returned = true;
    return {.left_mm_s = 200.0, .right_mm_s = 200.0};
  };
  check(robot->set_control(control).has_value(), "it takes a control function");
  check(robot->start().has_value(), "it starts");
  while (!inside) nap();
  return *std::move(robot);
}

enum class Way { close, destroy, replace, clear };

void let_hang(cargobay::Sim& sim, Way way) {
  inside = let_go = returned = false;
  {
    cargobay::Robot robot = hung_robot(sim);
    if (way == Way::close) {
      check_stalled(robot.close(), "closing says that it hangs");
      check(robot.handle() == nullptr, "it is closed all the same");
    }
    if (way == Way::replace) {
      const auto next = [](const cargobay::State&) { return cargobay::Wheels{100.0, 100.0}; };
      check_stalled(robot.set_control(next), "replacing it says that it hangs");
    }
    if (way == Way::clear) check_stalled(robot.set_control(nullptr), "so does clearing it");
  }
  check(sim.truth()->mode == cargobay::Mode::passive, "the robot stands, in Passive");
  let_go = true;
  while (!returned) nap();
  for (int i = 0; i < 100; ++i) nap();
  check(sim.truth()->commanded_left_mm_s == 0, "what comes back reaches nobody");
}

}  // namespace

int main() {
  for (const Way way : {Way::close, Way::destroy, Way::replace, Way::clear}) {
    auto sim = cargobay::Sim::open();
    check(sim.has_value(), "the virtual Create opens");
    let_hang(*sim, way);
    check(sim->close().has_value(), "the virtual Create closes");
  }
}
