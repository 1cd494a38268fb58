// A C++ control function that does not return is never freed: its thread is still in it.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
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

void nap() { std::this_thread::sleep_for(std::chrono::milliseconds{1}); }

cargobay::Robot hung_robot(cargobay::VirtualCreate& sim) {
  auto robot = cargobay::Robot::open({.flags = CARGOBAY_NO_CONFIG, .sim = &sim, .priority = 10});
  check(static_cast<bool>(robot), "it opens");
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
  check(static_cast<bool>(robot->control(control)), "it takes a control function");
  check(static_cast<bool>(robot->start()), "it starts");
  while (!inside) nap();
  return *std::move(robot);
}

}  // namespace

int main() {
  auto sim = cargobay::VirtualCreate::open();
  check(static_cast<bool>(sim), "the virtual Create opens");
  for (const bool by_destructor : {false, true}) {
    inside = let_go = returned = false;
    {
      cargobay::Robot robot = hung_robot(*sim);
      if (!by_destructor) {
        check(robot.close().code() == CARGOBAY_E_STALLED, "closing says that it hangs");
        check(robot.handle() == nullptr, "it is closed all the same");
      }
    }
    check(sim->truth()->mode == CARGOBAY_MODE_PASSIVE, "the robot stands, in Passive");
    let_go = true;
    while (!returned) nap();
    for (int i = 0; i < 100; ++i) nap();
    check(sim->truth()->commanded_left_mm_s == 0, "what comes back reaches nobody");
    check(static_cast<bool>(sim->close()), "the virtual Create closes");
    sim = cargobay::VirtualCreate::open();
  }
}
