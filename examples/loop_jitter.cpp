// How regularly your own loop wakes, compared with the control thread that it follows.
#include <cstdio>

#include <cargobay.hpp>

using Clock = std::chrono::steady_clock;

static void show(const char* whose, const cargobay::Histogram& histogram) {
  const auto held = histogram.distribution();
  if (!held) return;
  const auto ms = [](std::int64_t time_ns) { return 1e-6 * static_cast<double>(time_ns); };
  std::printf("%s: period p50 %.3f ms, p99 %.3f ms, longest %.3f ms\n", whose, ms(held->p50_ns),
              ms(held->p99_ns), ms(held->max_ns));
}

static cargobay::Expected<void> measure(const cargobay::Options& options) {
  auto histogram = cargobay::Histogram::open();
  if (!histogram) return histogram.error();
  auto robot = cargobay::Robot::open(options);
  if (!robot) return robot.error();
  if (auto started = robot->start(); !started) return started;
  if (auto first = robot->wait(std::chrono::seconds{1}); !first) return first.error();
  Clock::time_point before = Clock::now();
  for (int frame = 0; frame < 200; ++frame) {
    if (auto next = robot->wait(std::chrono::seconds{1}); !next) return next.error();
    const Clock::time_point woken = Clock::now();
    if (auto counted = histogram->record(woken - before); !counted) return counted;
    before = woken;
  }
  show("this thread", *histogram);
  auto copied = robot->copy_histogram(CARGOBAY_MEASURE_PERIOD, *histogram);
  if (!copied) return copied;
  show("control thread", *histogram);
  return robot->stop();
}

int main(int argc, char** argv) {
  const auto done = measure(argc > 1 ? cargobay::Options{.port = argv[1]}
                                     : cargobay::Options{.flags = CARGOBAY_NO_CONFIG});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
