// What a tick of the loop costs, part by part, each compared with the least that could replace it.

#include <array>
#include <cstring>
#include <limits>
#include <memory>

#include <benchmark/benchmark.h>

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_stream.hpp"
#include "oi/encode.hpp"
#include "rt/histogram.hpp"
#include "rt/mailbox.hpp"
#include "rt/velocity_controller.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_loop.hpp"
#include "tests/jitter/memory_stream.hpp"

namespace {

using namespace cargobay;  // NOLINT(google-build-using-namespace): the subject of this program

constexpr rt::WheelSpeeds kSpeeds{200.0, 150.0};

// The floor for anything that is one call a tick.
[[gnu::noinline]] void nothing() { benchmark::ClobberMemory(); }
void empty_call(benchmark::State& state) {
  for (auto _ : state) nothing();
}
BENCHMARK(empty_call);

void estimator_step(benchmark::State& state) {
  rt::WheelEstimator estimator{{}};
  const rt::WheelEstimator::Reading reading{.distance_mm = 3, .angle_deg = 0};
  for (auto _ : state) {
    estimator.step(kSpeeds, reading);
    benchmark::DoNotOptimize(estimator.speeds());
  }
}
BENCHMARK(estimator_step);

void controller_step(benchmark::State& state) {
  rt::VelocityController controller{{}};
  double estimate_mm_s = 190.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(estimate_mm_s);
    benchmark::DoNotOptimize(
        controller.command({200.0, 0.0, 200.0}, {.speed_mm_s = estimate_mm_s}));
  }
}
BENCHMARK(controller_step);

// Estimator, read schedule, acceleration limit and controllers of both wheels.
void wheel_loop(benchmark::State& state) {
  rt::WheelLoop loop{{}};
  for (auto _ : state) {
    loop.frame(rt::WheelEstimator::Reading{.distance_mm = 3, .angle_deg = 0});
    benchmark::DoNotOptimize(loop.control(kSpeeds));
    benchmark::DoNotOptimize(loop.next_reads());
  }
}
BENCHMARK(wheel_loop);

void histogram_record(benchmark::State& state) {
  rt::Histogram histogram;
  std::uint64_t value = 1;
  for (auto _ : state) {
    value = value * 6364136223846793005U + 1442695040888963407U;
    histogram.record(value >> 40U);
  }
  benchmark::DoNotOptimize(histogram.max());
}
BENCHMARK(histogram_record);

// The same numbers, each into one of as many counters as there are buckets.
void histogram_floor(benchmark::State& state) {
  std::array<std::uint64_t, 4096> counts{};
  std::uint64_t value = 1;
  for (auto _ : state) {
    value = value * 6364136223846793005U + 1442695040888963407U;
    ++counts[value >> 52U];
  }
  benchmark::DoNotOptimize(counts);
}
BENCHMARK(histogram_floor);

void mailbox_put(benchmark::State& state) {
  rt::Mailbox<hal::CycleState> mailbox;
  const hal::CycleState told{.tick = 1};
  for (auto _ : state) mailbox.put(told);
}
BENCHMARK(mailbox_put);

void mailbox_get(benchmark::State& state) {
  rt::Mailbox<hal::CycleState> mailbox;
  mailbox.put({.tick = 1});
  for (auto _ : state) benchmark::DoNotOptimize(mailbox.get());
}
BENCHMARK(mailbox_get);

void mailbox_floor(benchmark::State& state) {
  const hal::CycleState told{.tick = 1};
  hal::CycleState copy;
  for (auto _ : state) {
    std::memcpy(&copy, &told, sizeof copy);
    benchmark::DoNotOptimize(copy);
  }
}
BENCHMARK(mailbox_floor);

// A frame's way through the cycle, from one wait to the next.
struct Rounds {
  benchmark::State* state;
  hal::ControlCycle* cycle;
  static hal::ControlAnswer control(void* context, const hal::CycleState& /*state*/,
                                    double /*seconds*/) CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Rounds*>(context);
    if (!self.state->KeepRunning()) self.cycle->request_stop();
    return kSpeeds;
  }
};
void run(benchmark::State& state, hal::ByteStream& stream, const hal::StateObserver& observer) {
  const auto cycle = std::make_unique<hal::ControlCycle>(stream, hal::ControlCycle::Parameters{});
  Rounds rounds{&state, cycle.get()};
  cycle->set_control({.function = &Rounds::control, .context = &rounds});
  cycle->set_observer(observer);
  (void)cycle->run();
}
constexpr long kForEver = std::numeric_limits<long>::max();

void whole_cycle(benchmark::State& state) {
  test::MemoryStream stream{kForEver};
  run(state, stream, {});
}
BENCHMARK(whole_cycle);

void whole_cycle_recorded(benchmark::State& state) {
  test::MemoryStream stream{kForEver};
  hal::FlightRecorder recorder;
  hal::RecordingStream recorded{stream, recorder};
  run(state, recorded, recorder.observer());
}
BENCHMARK(whole_cycle_recorded);

// Its floor.
void bare_echo(benchmark::State& state) {
  const auto command = *oi::encode(oi::DriveDirect{.left = {}, .right = {}});
  std::array<std::uint8_t, 1024> bytes{};
  test::MemoryStream memory{kForEver};
  // Called as the cycle calls it: the compiler must not know which stream it is.
  hal::ByteStream* volatile unknown = &memory;
  hal::ByteStream& stream = *unknown;
  for (auto _ : state) {
    benchmark::DoNotOptimize(stream.wait({}));
    benchmark::DoNotOptimize(stream.read(bytes));
    benchmark::DoNotOptimize(stream.write(command));
  }
}
BENCHMARK(bare_echo);

}  // namespace
