// Readers in C++, in virtual time: each says what it has seen, and gets what is newer, whoever else
// reads.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#include "hal/c/cargobay.hpp"

namespace {

using cargobay::ErrorCode;
using cargobay::Event;
using cargobay::EventKind;
using cargobay::Packet;
using cargobay::State;
using namespace std::chrono_literals;

static_assert(std::ranges::input_range<cargobay::States>);
static_assert(std::ranges::input_range<cargobay::Events>);

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n  last error: %s\n", what, cargobay_error_message());
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

void check(const cargobay::Expected<void>& outcome, const char* what) {
  check(outcome.has_value(), what);
}

// A robot in virtual time, whose loop runs.
struct Drive {
  Drive() {
    check(sim.has_value() && robot.has_value(), "both open");
    check(robot->start(), "it starts");
  }

  void inject(const char* line) { check(sim->inject(line).has_value(), line); }
  void run(int frames) {
    auto states = robot->states(1s, robot->state().value_or(State{}).tick);
    for (auto state = states.begin(); state != states.end() && --frames > 0;) ++state;
    check(states.outcome(), "the loop goes on");
  }

  cargobay::Expected<cargobay::Sim> sim =
      cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  cargobay::Expected<cargobay::Robot> robot = cargobay::Robot::open({.sim = &*sim});
};

// As a coroutine would: takes one state each time it is resumed.
struct Reader {
  std::int64_t tick = -1;
  std::vector<std::int64_t> seen{};

  void resume(cargobay::Robot& robot) {
    const auto state = robot.wait(tick, 1s);
    check(state && state->tick > tick, "a newer state");
    tick = state->tick;
    seen.push_back(tick);
  }
};

void read_the_same_in_turns() {
  Drive drive;
  Reader one;
  Reader other;
  for (int i = 0; i < 100; ++i) {
    one.resume(*drive.robot);
    const auto now = drive.sim->truth()->sim_time;
    other.resume(*drive.robot);
    check(drive.sim->truth()->sim_time == now, "what is there already needs no time");
  }
  check(one.seen == other.seen, "each has seen all that the other has");
  check(one.seen.size() == 100 && one.seen.back() == one.seen.front() + 99, "and no gap");
  // One that comes late starts with the newest.
  Reader late;
  late.resume(*drive.robot);
  check(late.tick == one.tick, "the newest will do");
  late.resume(*drive.robot);
  check(late.tick == one.tick + 1, "and then the next");

  const auto now = drive.sim->truth()->sim_time;
  const auto none = drive.robot->wait(late.tick, 0s);
  check(!none && !none.ended() && none.code() == ErrorCode::timeout && !none.outcome(),
        "there is none yet");
  check(drive.sim->truth()->sim_time == now, "asking for one moves no time");
  check(drive.robot->wait(one.tick, 0s)->tick == late.tick, "the one that is there needs none");
}

void see_gaps_and_fill_them() {
  Drive drive;
  auto& robot = *drive.robot;
  auto slow = robot.states(1s);
  std::vector<std::int64_t> seen;
  for (const State& state : slow) {
    check(slow.skipped() == (seen.empty() ? 0 : 3), "it sees how many it missed");
    std::vector<State> missed(256);
    const std::int64_t before = seen.empty() ? state.tick - 1 : seen.back();
    const auto count = robot.history(before, missed);
    check(count && static_cast<std::int64_t>(*count) == state.tick - before, "it can have them");
    for (std::size_t i = 0; i < *count; ++i) seen.push_back(missed[i].tick);
    check(missed[*count - 1].x_mm == state.x_mm && missed[*count].tick == -1, "up to this one");
    if (seen.size() > 60) break;
    drive.run(4);
  }
  check(std::ranges::adjacent_find(seen, [](auto a, auto b) { return b != a + 1; }) == seen.end(),
        "nothing is missing, nothing twice");
  // A second `for` goes on.
  drive.run(1);
  check((*slow.begin()).tick == seen.back() + 1 && slow.skipped() == 0, "where it was left");

  drive.run(300);
  std::vector<State> all(1000);
  const auto kept = robot.history(-1, all);
  check(kept && *kept == 256 && all[255].tick == robot.state()->tick, "the newest 256 are kept");
  std::array<State, 3> few;
  check(*robot.history(all[100].tick, few) == 3 && few[0].tick == all[101].tick &&
            few[2].tick == all[103].tick,
        "the oldest come first, as many as there is room for");
  check(*robot.history(all[255].tick, few) == 0, "or none");
  check(robot.history(-1, {}).error().code == ErrorCode::argument, "room for none makes no sense");
}

// What each would handle: its own list of sequence numbers.
std::vector<std::int64_t> drain(cargobay::Events& events) {
  std::vector<std::int64_t> sequences;
  for (const Event& event : events) sequences.push_back(event.sequence);
  return sequences;
}

void read_the_same_events() {
  Drive drive;
  auto& robot = *drive.robot;
  auto logger = robot.events();
  auto monitor = robot.events();
  drive.run(5);
  drive.inject("bump left");
  drive.run(10);
  const auto first = robot.next_event(0);
  check(first && first->kind == EventKind::bump_began && first->bumps == cargobay::Bump::left,
        "it is there");
  check(
      event_name(first->kind) == "bump_began" && describe(*first).find("left") != std::string::npos,
      "with its words");
  check(drain(logger) == std::vector<std::int64_t>{first->sequence}, "one reader gets it");
  check(drain(logger).empty(), "once");
  drive.inject("bump none");
  drive.run(10);
  const auto both = drain(monitor);
  check(both.size() == 2 && both[0] == first->sequence && both[1] == both[0] + 1, "another, both");
  check(drain(logger) == std::vector{both[1]}, "the first one goes on");
  check(robot.next_event(both[1]) == std::nullopt, "there is no other");

  for (int i = 0; i < 200; ++i) {
    drive.inject(i % 2 == 0 ? "bump right" : "bump none");
    drive.run(6);
  }
  auto late = robot.events();
  std::int64_t expected = 1;
  for (const Event& event : late) {
    check(event.sequence == expected + late.skipped(), "what is gone is counted");
    expected = event.sequence + 1;
  }
  check(expected - 1 == static_cast<std::int64_t>(robot.statistics()->events), "up to the newest");
  check(drain(monitor).size() == 200, "a reader that keeps up misses none");
}

void tell_the_end_from_a_state() {
  Drive drive;
  auto& robot = *drive.robot;
  auto states = robot.states(1s);
  int count = 0;
  for (const State& state : states) {
    if (++count == 10) check(robot.request_end(), "it is asked to end");
    check(state.mode == cargobay::Mode::safe, "until then it drives");
  }
  check(count >= 10 && count <= 12 && states.outcome(), "the states end, which is no error");
  check(!states.has_current(), "there is none to look at");
  check(robot.close(), "it is closed");
  const auto closed = robot.wait(-1, 0s);
  check(!closed && !closed.ended() && closed.code() == ErrorCode::handle, "that is an error");
  for ([[maybe_unused]] const State& state : states) check(false, "a closed robot has no state");
  check(states.outcome().error().code == ErrorCode::handle, "its reader says so, too");
  check(!robot.next_event(0) && robot.readings(Packet::wall).error().code == ErrorCode::handle,
        "nor events or readings");
  check(cargobay::Robot::open({.sim = &*drive.sim}).has_value(), "the virtual Create is free");
  check(drive.sim->close(), "it is closed");
  const auto lost = cargobay::Robot::open({.sim = &*drive.sim});
  check(!lost && lost.error().code == ErrorCode::handle, "a closed one is not another robot");
}

void read_packets() {
  Drive drive;
  auto& robot = *drive.robot;
  check(robot.readings(Packet::wall).error().code == ErrorCode::no_frame, "no frame has come");
  drive.run(100);
  const auto [wall, signal] = *robot.readings(Packet::wall, Packet::wall_signal);
  check(wall.packet == Packet::wall && wall.tick > 80 && wall.arrival > 0s, "one comes always");
  check(signal.packet == Packet::wall_signal && signal.tick == -1, "the other on request");
  const std::array packets{Packet::wall_signal, Packet::cliff_left_signal};
  check(robot.subscribe(packets) && robot.subscribe(Packet::wall_signal), "it is subscribed to");
  drive.inject("wall on");
  drive.run(60);
  const auto streamed = robot.reading(Packet::wall_signal);
  check(streamed && streamed->value > 100 && streamed->tick > signal.tick, "and streamed");
  check(robot.unsubscribe(packets) && robot.unsubscribe(Packet::wall_signal), "taken back");
  check(robot.unsubscribe(Packet::wall_signal).error().code == ErrorCode::argument, "once each");
  std::array<cargobay::Reading, 1> few;
  check(robot.readings(packets, few).error().code == ErrorCode::argument, "room for each");
  const std::vector<Packet> many(65, Packet::wall);
  std::vector<cargobay::Reading> readings(65);
  check(robot.readings(many, readings).error().code == ErrorCode::argument, "64 at most");
  check(robot.subscribe(many).error().code == ErrorCode::argument, "here, too");
  drive.inject("analog-in 777");
  const auto asked = robot.query(Packet::analog_signal, 1s);
  check(asked && asked->value == 777 && asked->packet == Packet::analog_signal, "or asked for");
  check(packet_name(Packet::analog_signal) == "analog_signal", "by name");
}

}  // namespace

int main() {
  read_the_same_in_turns();
  see_gaps_and_fill_them();
  read_the_same_events();
  tell_the_end_from_a_state();
  read_packets();
}
