// How regularly your own loop wakes, compared with the control thread that it follows.
#include <cstdio>

#include <cargobay.hpp>

using Clock = std::chrono::steady_clock;

static void show(const char* whose, const cargobay::Histogram& histogram) {
  const auto held = histogram.distribution().value_or(cargobay::Distribution{});
  const auto ms = [](std::chrono::duration<double, std::milli> time) { return time.count(); };
  std::printf("%s: period p50 %.3f ms, p99 %.3f ms, longest %.3f ms\n", whose, ms(held.p50),
              ms(held.p99), ms(held.max));
}

static cargobay::Expected<void> measure(const cargobay::Options& options) {
  auto histogram = cargobay::Histogram::open();
  if (!histogram) return cargobay::Unexpected{histogram.error()};
  auto robot = cargobay::Robot::open(options);
  if (!robot) return cargobay::Unexpected{robot.error()};
  if (auto started = robot->start(); !started) return started;
  std::optional<Clock::time_point> before;
  auto states = robot->states(std::chrono::seconds{1});
  for (const cargobay::State& state : states) {
    const Clock::time_point woken = Clock::now();
    if (before) (void)histogram->record(woken - *before);  // fails only once it is closed
    before = woken;
    if (state.tick < 200) continue;
    show("this thread", *histogram);
    auto copied = robot->copy_histogram(cargobay::Measure::period, *histogram);
    if (!copied) return copied;
    show("control thread", *histogram);
    return robot->end();
  }
  return states.outcome();
}

int main(int argc, char** argv) {
  const auto done = measure(argc > 1 ? cargobay::Options{.port = argv[1]}
                                     : cargobay::Options{.flags = cargobay::Flag::no_config});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
