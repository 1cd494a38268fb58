// Control functions that are changed while the control thread calls them: none is freed before it
// has returned for the last time.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "hal/c/cargobay.hpp"

namespace {

using cargobay::Flag;
using cargobay::State;
using cargobay::Wheels;
using namespace std::chrono_literals;

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n  last error: %s\n", what, cargobay_error_message());
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

void check(const cargobay::Expected<void>& outcome, const char* what) {
  check(outcome.has_value(), what);
}

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): seen by thread and destructor
std::atomic<int> inside{0};
std::atomic<int> calls{0};
std::atomic<bool> freed_inside{false};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

// Takes its time, and sees whether it is freed meanwhile.
class Slow {
 public:
  explicit Slow(std::chrono::microseconds duration) : duration_{duration} {}
  Slow(Slow&&) = default;
  Slow& operator=(Slow&&) = delete;
  Slow(const Slow&) = delete;
  Slow& operator=(const Slow&) = delete;
  ~Slow() {
    if (inside != 0) freed_inside = true;
  }

  Wheels operator()(const State& /*state*/) const {
    ++inside;
    ++calls;
    const auto end = std::chrono::steady_clock::now() + duration_;
    while (std::chrono::steady_clock::now() < end) {
    }
    --inside;
    return {.left_mm_s = 50.0, .right_mm_s = 50.0};
  }

 private:
  std::chrono::microseconds duration_;
};

cargobay::Robot running(cargobay::Sim& sim, std::chrono::nanoseconds budget) {
  auto robot = cargobay::Robot::open({.flags = Flag::no_config,
                                      .sim = &sim,
                                      .control_overruns = 1000,
                                      .priority = 10,
                                      .control_budget = budget});
  check(robot && robot->start(), "it starts");
  return *std::move(robot);
}

void frame(cargobay::Robot& robot) {
  check(robot.wait(robot.state().value_or(State{}).tick, 2s).outcome(), "a frame comes");
}

// While each of them runs.
void are_changed(cargobay::Sim& sim) {
  cargobay::Robot robot = running(sim, 100ms);
  check(robot.set_control(Slow{3ms}), "the first one");
  for (int i = 0; i < 50; ++i) {
    while (inside == 0) std::this_thread::yield();
    check(robot.set_control(Slow{3ms}), "another one");
    check(!freed_inside, "the former one has returned");
  }
  check(robot.set_control(nullptr) && inside == 0 && calls >= 50, "the last one, too");
  check(robot.end() && robot.end_report()->code == cargobay::ErrorCode::ok, "the loop was well");
}

// Standing still clears the function, from any thread, and does not wait for it: what comes next
// has to.
void are_cleared_by_standing_still(cargobay::Sim& sim) {
  cargobay::Robot robot = running(sim, 100ms);
  for (int i = 0; i < 20; ++i) {
    check(robot.set_control(Slow{5ms}), "it is set");
    while (inside == 0) std::this_thread::yield();
    check(robot.stop(), "it stands still");
    check(robot.set_control(nullptr), "nothing is set any more");
    check(inside == 0 && !freed_inside, "and the function has returned");
  }
  const int before = calls;
  for (int i = 0; i < 5; ++i) frame(robot);
  check(calls == before, "it is not called again");
}

}  // namespace

int main() {
  auto sim = cargobay::Sim::open();
  check(sim.has_value(), "the virtual Create opens");
  are_changed(*sim);
  are_cleared_by_standing_still(*sim);
}
