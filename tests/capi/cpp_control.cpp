// Control functions in C++, in virtual time: set, changed and cleared while the loop runs,
// finished, failed, thrown from; and when each is freed.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "hal/c/cargobay.hpp"

namespace {

using cargobay::ErrorCode;
using cargobay::Output;
using cargobay::State;
using cargobay::Twist;
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

void check_fails(const cargobay::Expected<void>& outcome, ErrorCode code, const char* what) {
  if (!outcome && outcome.error().code != code)
    std::fprintf(stderr, "%s\n", outcome.error().message);
  check(!outcome && outcome.error().code == code, what);
}

bool near(double value, double wanted) { return std::abs(value - wanted) < 0.01; }

bool near(Wheels value, double left_mm_s, double right_mm_s) {
  return near(value.left_mm_s, left_mm_s) && near(value.right_mm_s, right_mm_s);
}

// The state some frames on.
State run(cargobay::Robot& robot, int frames) {
  auto states = robot.states(1s, robot.state().value_or(State{}).tick);
  State last;
  for (const State& state : states) {
    last = state;
    if (--frames == 0) return last;
  }
  check(false, "the loop goes on");
  return last;
}

// A robot in virtual time, whose loop runs.
struct Drive {
  Drive() {
    check(sim.has_value() && robot.has_value(), "both open");
    check(robot->start(), "it starts");
  }

  cargobay::Expected<cargobay::Sim> sim =
      cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  cargobay::Expected<cargobay::Robot> robot = cargobay::Robot::open({.sim = &*sim});
};

// Drives at this speed; what it holds shows when it is freed.
struct Steady {
  double speed_mm_s;
  std::shared_ptr<int> calls;

  Wheels operator()(const State& state) const {
    ++*calls;
    check(state.tick >= 0 && near(state.target, 0.0, 0.0) && near(state.command, 0.0, 0.0),
          "what is not decided yet is 0");
    return {speed_mm_s, speed_mm_s};
  }
};

void is_changed_and_cleared() {
  Drive drive;
  auto& robot = *drive.robot;
  auto first = std::make_shared<int>(0);
  auto second = std::make_shared<int>(0);
  check(robot.set_control(Steady{100.0, first}), "it is set while the loop runs");
  check(near(run(robot, 10).target, 100.0, 100.0) && *first == 10, "it is called once a frame");
  check(first.use_count() == 2, "one copy is kept");
  check(robot.set_control(Steady{-50.0, second}), "it is changed while the loop runs");
  check(first.use_count() == 1, "the former one is freed");
  check(near(run(robot, 10).target, -50.0, -50.0) && *first == 10, "and no longer called");
  check(robot.drive(70.0, 0.0), "a setpoint is taken");
  check(near(run(robot, 1).target, -50.0, -50.0), "but the function decides");
  check(robot.set_control(nullptr), "it is cleared");
  check(second.use_count() == 1 && *second == 11, "and freed");
  check(near(run(robot, 1).target, 70.0, 70.0), "the setpoint counts again");

  check(robot.set_control(Steady{100.0, first}), "it is set again");
  check(near(run(robot, 5).target, 100.0, 100.0), "and drives");
  check(robot.stop(), "it stands still");
  check(near(run(robot, 60).command, 0.0, 0.0) && *first == 15, "its function is cleared");
  check(robot.drive(70.0, 0.0), "the next setpoint");
  check(near(run(robot, 1).target, 70.0, 70.0), "drives");
  check(robot.set_control(Steady{100.0, second}), "one more");
  check(first.use_count() == 1, "the one that was cleared by standing still is freed");

  // Where it lies in memory does not change.
  cargobay::Robot elsewhere = std::move(robot);
  check(near(run(elsewhere, 5).target, 100.0, 100.0) && *second == 16, "it moves with its robot");
  // NOLINTNEXTLINE(bugprone-use-after-move): it has no handle any more, and says so
  check_fails(robot.set_control(nullptr), ErrorCode::handle, "the other has none");
  check(elsewhere.close() && second.use_count() == 2, "it is freed");
  elsewhere = *cargobay::Robot::open({.sim = &*drive.sim});
  check(second.use_count() == 1, "at the latest with the robot");
  check(elsewhere.set_control(Steady{1.0, first}) && first.use_count() == 2, "it is set, not run");
  elsewhere = *cargobay::Robot::open({.flags = cargobay::Flag::no_config});
  check(first.use_count() == 1, "a robot that is replaced is closed and frees it");
}

// The mode in which the robot is when the function is freed: Passive once its loop has ended.
void is_freed_after_its_loop() {
  for (const bool by_assignment : {false, true}) {
    Drive drive;
    auto mode = cargobay::Mode::off;
    const auto look = [&](void*) { mode = drive.sim->truth()->mode; };
    {
      cargobay::Robot robot = *std::move(drive.robot);
      check(robot.set_control([held = std::shared_ptr<void>(nullptr, look)](const State&) {
        return Wheels{100.0, 100.0};
      }),
            "it is set");
      check(near(run(robot, 5).target, 100.0, 100.0) && mode == cargobay::Mode::off, "it drives");
      if (by_assignment) robot = *cargobay::Robot::open({.flags = cargobay::Flag::no_config});
      check(mode == (by_assignment ? cargobay::Mode::passive : cargobay::Mode::off), "not before");
    }
    check(mode == cargobay::Mode::passive, "the loop ends first");
  }
}

// What is refused is not kept, and the one before stays.
void refused_is_freed() {
  Drive drive;
  const auto kept = std::make_shared<int>(0);
  const auto refused = std::make_shared<int>(0);
  auto code = ErrorCode::ok;
  check(drive.robot->set_control([&, kept](const State&) -> Output {
    const auto outcome = drive.robot->set_control(Steady{1.0, refused});
    code = outcome ? ErrorCode::ok : outcome.error().code;
    return Wheels{30.0, 30.0};
  }),
        "it is set");
  check(near(run(*drive.robot, 3).target, 30.0, 30.0), "it is not changed from within");
  check(code == ErrorCode::thread, "but told so");
  check(kept.use_count() == 2 && refused.use_count() == 1, "only the one refused is freed");
}

void drives_as_it_says() {
  Drive drive;
  auto& robot = *drive.robot;
  Twist twist{500.0, 0.5};
  check(robot.set_control([&](const State&) { return twist; }), "a twist");
  const State state = run(robot, 2);
  const double base_mm = robot.info()->wheel_base_mm;
  const double scale = 500.0 / (500.0 + 0.5 * base_mm / 2.0);
  check(near(state.target, scale * (500.0 - 0.5 * base_mm / 2.0), 500.0), "is scaled down");
  const auto wheels = robot.wheels_of(twist);
  check(wheels && near(state.target, wheels->left_mm_s, wheels->right_mm_s), "as wheels_of() says");
  twist = {-200.0, 0.25};
  check(near(run(robot, 1).target, -200.0 - 0.125 * base_mm, -200.0 + 0.125 * base_mm),
        "but not if that is not necessary");

  // By turns: even frames leave it to the setpoint.
  check(robot.set_control([](const State& seen) -> Output {
    if (seen.tick % 2 == 0) return Output::setpoint();
    return Wheels{-100.0, -100.0};
  }),
        "one that leaves it to the setpoint");
  check(robot.drive_wheels({80.0, 90.0}), "a setpoint");
  for (int i = 0; i < 4; ++i) {
    const State next = run(robot, 1);
    const bool even = next.tick % 2 == 0;
    check(near(next.target, even ? 80.0 : -100.0, even ? 90.0 : -100.0), "each in its frame");
  }

  // A copy: it lasts, and may be kept.
  std::optional<State> kept;
  check(robot.set_control([&](const State& seen) {
    if (!kept) kept = seen;
    return Wheels{};
  }),
        "one that keeps a state");
  const State next = run(robot, 1);
  (void)run(robot, 5);
  check(kept && kept->tick == next.tick && kept->arrival == next.arrival &&
            kept->x_mm == next.x_mm && kept->elapsed == 15ms,
        "which is that of its first frame");
}

void refuses_what_is_no_speed() {
  Drive drive;
  auto& robot = *drive.robot;
  check(robot.set_control([](const State& state) {
    return Wheels{state.tick % 2 == 0 ? std::nan("") : 501.0, 0.0};
  }),
        "what no robot can follow");
  check(near(run(robot, 4).target, 0.0, 0.0), "stops the wheels");
  check(robot.statistics()->controls_refused == 4, "and is counted");
  auto events = robot.events();
  check(events.begin() != events.end() &&
            events.current().kind == cargobay::EventKind::control_refused,
        "and reported");
}

void finishes() {
  Drive drive;
  auto& robot = *drive.robot;
  check(!robot.end_report()->ended, "the loop has not ended");
  check(robot.set_control([](const State& state) -> Output {
    if (state.tick >= 50) return Output::finished();
    return Wheels{100.0, 100.0};
  }),
        "one that finishes");
  auto states = robot.states(1s);
  std::int64_t last = -1;
  for (const State& state : states) last = state.tick;
  check(last >= 49 && last <= 51 && states.outcome(), "the states end, and that is no error");
  const auto waited = robot.wait(last, 1s);
  check(!waited && waited.ended() && waited.code() == ErrorCode::ok, "nor is it a state");
  check(robot.end(), "it has ended as asked");
  const auto report = robot.end_report();
  check(report->ended && report->code == ErrorCode::ok && report->control_result == 1,
        "it says so");
  check(report->passive_seen && report->message[0] == '\0', "and stands, in Passive");
  check(drive.sim->truth()->commanded_left_mm_s == 0, "without a command");

  // On from there, with the odometry and the ticks.
  const double ahead_mm = robot.state()->x_mm;
  check(ahead_mm > 20.0 && robot.start(), "it starts again");
  check(robot.set_control(nullptr), "without a function");
  const State state = run(robot, 2);
  check(state.tick > last && state.x_mm >= ahead_mm && state.x_mm < ahead_mm + 50.0, "from there");
  check(robot.request_end() && robot.end(), "and ends when asked");
}

void fails(int reason, int wanted) {
  Drive drive;
  auto& robot = *drive.robot;
  check(robot.set_control([reason](const State& state) -> Output {
    if (state.tick >= 20) return Output::failed(reason);
    return Twist{100.0, 0.0};
  }),
        "one that fails");
  auto states = robot.states(1s);
  for ([[maybe_unused]] const State& state : states) continue;
  check_fails(states.outcome(), ErrorCode::control, "the states end with the error");
  check_fails(robot.end(), ErrorCode::control, "so does the loop");
  const auto report = robot.end_report();
  check(report->code == ErrorCode::control && report->control_result == wanted, "with the reason");
  check(drive.sim->truth()->mode == cargobay::Mode::passive, "the robot stands");
}

void throws() {
  Drive drive;
  auto& robot = *drive.robot;
  check(robot.set_control([](const State& state) -> Wheels {
    if (state.tick >= 20) throw std::runtime_error{"planted"};
    return {100.0, 100.0};
  }),
        "one that throws");
  auto states = robot.states(1s);
  for ([[maybe_unused]] const State& state : states) continue;
  check_fails(states.outcome(), ErrorCode::control, "the exception goes no further");
  check(std::string{states.outcome().error().message}.find("exception") != std::string::npos,
        "and is named");
  check_fails(robot.end(), ErrorCode::control, "the loop has ended");
  check(robot.end_report()->control_result == 0, "without a result");
}

}  // namespace

int main() {
  is_changed_and_cleared();
  is_freed_after_its_loop();
  refused_is_freed();
  drives_as_it_says();
  refuses_what_is_no_speed();
  finishes();
  fails(-42, -42);
  fails(5, -1);
  throws();
}
