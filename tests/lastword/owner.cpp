// Like owner.c, in C++: with handles that close themselves, and exceptions.
//
// usage: owner_cpp PORT opened|driving return|exit|throw|bad_alloc|throw_in_control|endless|drive|
//        until_the_end|close_range|finish
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string_view>

#include "hal/c/cargobay.hpp"

namespace {

enum class Deed : std::uint8_t { drive, loop, fail };
volatile Deed deed = Deed::drive;

void say(const char* what, int code, int number) {
  std::printf("%s %d %d\n", what, code, number);
  std::fflush(stdout);
}

// The code as C has it; 0 for success.
int code_of(const cargobay::Expected<void>& outcome) {
  return outcome ? 0 : static_cast<int>(outcome.error().code);
}

int complain(const char* what, const cargobay::Error& error) {
  std::fprintf(stderr, "%s: %d: %s\n", what, static_cast<int>(error.code), error.message);
  return 1;
}

cargobay::Wheels control(const cargobay::State& /*state*/) {
  while (deed == Deed::loop) {
  }
  if (deed == Deed::fail) throw std::runtime_error{"the controller has a bug"};
  return {200.0, 200.0};
}

int finish(cargobay::Robot& robot) {
  const auto begin = std::chrono::steady_clock::now();
  const auto stopped = robot.end();
  const auto took = std::chrono::steady_clock::now() - begin;
  say("stop", code_of(stopped),
      static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(took).count()));
  return stopped ? 0 : complain("stop", stopped.error());
}

int until_the_end(cargobay::Robot& robot) {
  int frames = 0;
  auto states = robot.states(std::chrono::seconds{1});
  for (auto state = states.begin(); state != states.end() && frames < 2000; ++state) ++frames;
  const auto waited = states.outcome();
  say("wait", code_of(waited), frames);
  if (!waited) (void)complain("wait", waited.error());
  return finish(robot) == 0 && waited ? 0 : 1;
}

int end_by(std::string_view way, cargobay::Robot& robot) {
  if (way == "return") return 0;
  if (way == "finish") return finish(robot);
  if (way == "exit") std::exit(3);  // NOLINT(concurrency-mt-unsafe): as users do
  if (way == "throw") throw std::runtime_error{"nobody catches this"};
  if (way == "bad_alloc") throw std::bad_alloc{};
  if (way == "close_range") close_range(3, ~0U, 0);
  if (way == "throw_in_control") deed = Deed::fail;
  if (way == "endless") deed = Deed::loop;
  if (way == "drive") {
    for (;;) pause();
  }
  return until_the_end(robot);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const rlimit no_core{.rlim_cur = 0, .rlim_max = 0};
  setrlimit(RLIMIT_CORE, &no_core);
  auto robot = cargobay::Robot::open({.flags = cargobay::Flag::no_config, .port = argv[1]});
  if (!robot) return complain("open", robot.error());
  std::puts("open");
  std::fflush(stdout);
  if (std::string_view{argv[2]} == "driving") {
    if (auto set = robot->set_control(control); !set) return complain("control", set.error());
    if (auto started = robot->start(); !started) return complain("start", started.error());
    auto states = robot->states(std::chrono::seconds{1});
    for (const cargobay::State& state : states) {
      if (state.tick >= 40) break;
    }
    if (auto waited = states.outcome(); !waited) return complain("wait", waited.error());
    std::puts("driving");
    std::fflush(stdout);
  }
  return end_by(argv[3], *robot);
}
