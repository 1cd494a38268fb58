// What is real-time safe in C allocates nothing in C++ either, whether it succeeds or fails.
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "hal/c/cargobay.hpp"

namespace {
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): operator new has no other
std::atomic<long> allocations{0};
}  // namespace

// Not inlined, or g++ sees free() where it expects delete.
// NOLINTBEGIN(cppcoreguidelines-no-malloc): these are what new and delete are made of
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc{};
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
// NOLINTEND(cppcoreguidelines-no-malloc)

namespace {

using cargobay::Packet;
using cargobay::State;
using namespace std::chrono_literals;

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n  last error: %s\n", what, cargobay_error_message());
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

// Everything that is real-time safe, once; `open` says whether the robot is.
void use(cargobay::Robot& robot, bool open) {
  std::array<State, 20> states;
  bool all = robot.state().has_value() == open;
  all &= robot.history(-1, states).has_value() == open;
  all &= robot.info().has_value() == open && robot.bring_up().has_value() == open;
  all &= robot.statistics().has_value() == open;
  all &= robot.readings(Packet::wall, Packet::voltage).has_value() == open;
  all &= robot.reading(Packet::wall).has_value() == open;
  all &= robot.drive(100.0, 0.1).has_value() == open;
  all &= robot.drive({100.0, 0.1}).has_value() == open;
  all &= robot.drive_wheels({100.0, 100.0}).has_value() == open;
  all &= robot.drive_radius(100.0, 500.0).has_value() == open;
  all &= robot.wheels_of({100.0, 0.1}).has_value() == open;
  all &= robot.stop().has_value() == open;
  all &= robot.rearm().has_value() == open && robot.expect_silence(1s).has_value() == open;
  all &= !robot.drive(0.0, std::nan("")).has_value();
  all &= robot.wait(1'000'000, 0s).code() != cargobay::ErrorCode::ok;
  auto events = robot.events();
  for ([[maybe_unused]] const cargobay::Event& event : events) all &= open;
  all &= cargobay::mode_name(cargobay::Mode::safe) == "safe" && cargobay::setting(0).has_value();
  check(all, "each does what it is to do");
}

// During a second of driving.
long allocations_of_a_second(cargobay::Robot& robot) {
  const long before = allocations;
  auto states = robot.states(1s, robot.state().value_or(State{}).tick);
  int frames = 0;
  for (auto state = states.begin(); state != states.end() && frames < 67; ++state) ++frames;
  check(frames == 67, "it drives");
  return allocations - before;
}

}  // namespace

int main() {
  auto sim = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  auto robot = cargobay::Robot::open({.flags = cargobay::Flag::hold_on_mode_loss, .sim = &*sim});
  check(robot && robot->start(), "it starts");
  (void)allocations_of_a_second(*robot);  // the first time
  const long without = allocations_of_a_second(*robot);
  const std::array<double, 8> held{50.0};
  const auto set = robot->set_control([held, calls = 0](const State& state) mutable {
    return cargobay::Wheels{held[0], state.tick < ++calls ? 0.0 : held[0]};
  });
  check(set.has_value(), "it takes a control function");
  check(allocations_of_a_second(*robot) == without, "calling it allocates nothing");
  check(robot->set_control(nullptr).has_value(), "it is cleared");

  for (const bool open : {true, false}) {
    if (!open) check(robot->close().has_value(), "it closes");
    const long before = allocations;
    use(*robot, open);
    check(allocations == before, open ? "nothing is allocated" : "not by what fails, either");
  }
  check(sim->inject("state").has_value() && allocations > 0, "but allocations are counted");
}
