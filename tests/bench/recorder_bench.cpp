// What the flight recorder costs a control cycle: a frame's way through it, without and with.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include <benchmark/benchmark.h>

#include "hal/control_cycle.hpp"
#include "hal/flight_recorder.hpp"
#include "hal/recording_stream.hpp"
#include "oi/encode.hpp"

namespace {

using namespace cargobay;  // NOLINT(google-build-using-namespace): the subject of this program

// A line on which a frame is there whenever it is waited for, and takes no time to read.
class ReadyLine final : public hal::ByteStream {
 public:
  ReadyLine() {
    oi::SensorValues values;
    values.set(oi::PacketId::oi_mode, 2);
    values.set(oi::PacketId::distance, 3);
    values.set(oi::PacketId::angle, 0);
    (void)oi::encode_frame(hal::kReadingList, values, oi::Checksum::including_header, frame_);
  }
  Wait wait(rt::TimePoint /*deadline*/) noexcept CARGOBAY_NONBLOCKING override {
    time_ += oi::kTick;
    return Wait::ready;
  }
  Transfer read(std::span<std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override {
    std::copy(frame_.begin(), frame_.end(), bytes.begin());
    return {.count = frame_.size()};
  }
  Transfer write(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override {
    return {.count = bytes.size()};
  }
  rt::TimePoint now() const noexcept CARGOBAY_NONBLOCKING override { return time_; }
  std::uint32_t baud() const override { return 57600; }
  std::error_code set_baud(std::uint32_t /*baud*/) override { return {}; }
  std::error_code set_wake_threshold(std::size_t /*bytes*/) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration /*timeout*/) override { return true; }

 private:
  std::array<std::uint8_t, hal::kFrameBytes> frame_{};
  rt::TimePoint time_{};
};

struct Rounds {
  benchmark::State* state;
  hal::ControlCycle* cycle;
  static rt::WheelSpeeds control(void* context, const hal::CycleState& /*state*/,
                                 double /*seconds*/) noexcept CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Rounds*>(context);
    if (!self.state->KeepRunning()) self.cycle->request_stop();
    return {200.0, 200.0};
  }
};

void run(benchmark::State& state, hal::ByteStream& stream, const hal::StateObserver& observer) {
  const auto cycle = std::make_unique<hal::ControlCycle>(stream, hal::ControlCycle::Parameters{});
  Rounds rounds{&state, cycle.get()};
  cycle->set_control({.function = &Rounds::control, .context = &rounds});
  cycle->set_observer(observer);
  (void)cycle->run();
}

void frame_unrecorded(benchmark::State& state) {
  ReadyLine line;
  run(state, line, {});
}
BENCHMARK(frame_unrecorded);

void frame_recorded(benchmark::State& state) {
  ReadyLine line;
  hal::FlightRecorder recorder;
  hal::RecordingStream recorded{line, recorder};
  run(state, recorded,
      {.function =
           [](void* to, const hal::CycleState& tick) noexcept CARGOBAY_NONBLOCKING {
             static_cast<hal::FlightRecorder*>(to)->state(tick);
           },
       .context = &recorder});
}
BENCHMARK(frame_recorded);

}  // namespace
