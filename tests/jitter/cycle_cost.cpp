// cycle_cost PART FRAMES: does one part of the control cycle, or all of it, for so many frames, on
// a stream in memory. tests/jitter/cost.sh counts the instructions. Parts: cycle, echo, decode,
// loop.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "hal/byte_stream.hpp"
#include "hal/control_cycle.hpp"
#include "hal/frame_lists.hpp"
#include "oi/encode.hpp"
#include "oi/frame.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/wheel_loop.hpp"

namespace {

using namespace cargobay;  // NOLINT(google-build-using-namespace): a program of its own

using FrameBytes = std::array<std::uint8_t, hal::kFrameBytes>;

FrameBytes frame_of(hal::FrameList list) {
  oi::SensorValues values;
  for (std::uint8_t id = oi::kFirstSinglePacket; id <= oi::kLastPacket; ++id)
    values.set(oi::PacketId{id}, 0);
  values.set(oi::PacketId::oi_mode, static_cast<std::int32_t>(oi::Mode::safe));
  values.set(oi::PacketId::distance, 3);
  values.set(oi::PacketId::voltage, 16'000);
  FrameBytes bytes{};
  (void)oi::encode_frame(hal::packets(list), values, oi::Checksum::including_header, bytes);
  return bytes;
}

// A frame each 15 ms, of the list that was asked for last; ends by hanging up.
class MemoryStream final : public hal::ByteStream {
 public:
  explicit MemoryStream(long frames) : frames_left_{frames} {}

  Wait wait(rt::TimePoint /*deadline*/) noexcept CARGOBAY_NONBLOCKING override {
    now_ += oi::kTick;
    return --frames_left_ < 0 ? Wait::hung_up : Wait::ready;
  }
  Transfer read(std::span<std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override {
    const FrameBytes& frame = frames_[list_];
    std::memcpy(bytes.data(), frame.data(), frame.size());
    return {.count = frame.size()};
  }
  // A list stands behind the Drive Direct; its second packet tells which it is.
  Transfer write(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override {
    if (bytes.size() > 8) list_ = bytes[8] == 2 ? 0 : bytes[8] == 1 ? 1 : 2;
    return {.count = bytes.size()};
  }
  rt::TimePoint now() const noexcept CARGOBAY_NONBLOCKING override { return now_; }
  std::uint32_t baud() const override { return 57600; }
  std::error_code set_baud(std::uint32_t /*baud*/) override { return {}; }
  std::error_code set_wake_threshold(std::size_t /*bytes*/) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration /*timeout*/) override { return true; }

 private:
  long frames_left_;
  rt::TimePoint now_{};
  std::size_t list_ = 0;
  std::array<FrameBytes, 3> frames_{frame_of(hal::FrameList::reading),
                                    frame_of(hal::FrameList::hazards),
                                    frame_of(hal::FrameList::battery)};
};

rt::WheelSpeeds decide(void* /*context*/, const hal::CycleState& /*state*/,
                       double /*seconds*/) noexcept CARGOBAY_NONBLOCKING {
  return {200.0, 200.0};
}

void cycle(long frames) {
  MemoryStream stream{frames};
  const auto it = std::make_unique<hal::ControlCycle>(stream, hal::ControlCycle::Parameters{});
  it->set_control({.function = &decide});
  (void)it->run();
  if (it->frames().lost != 0 || it->withheld_commands() != 0) std::abort();
}

void echo(long frames) {
  MemoryStream memory{frames};
  // Called as the cycle calls it: which stream it is the compiler is not to know.
  hal::ByteStream* volatile unknown = &memory;
  hal::ByteStream& stream = *unknown;
  const auto command = *oi::encode(oi::DriveDirect{.left = {}, .right = {}});
  std::array<std::uint8_t, 1024> bytes{};
  while (stream.wait({}) == hal::ByteStream::Wait::ready) {
    (void)stream.read(bytes);
    (void)stream.write(command);
  }
}

void decode(long frames) {
  const FrameBytes frame = frame_of(hal::FrameList::reading);
  oi::StreamDecoder decoder;
  oi::SensorValues values;
  for (long i = 0; i < frames; ++i) {
    for (const std::uint8_t byte : frame) {
      if (decoder.push(byte) != oi::StreamDecoder::Outcome::frame) continue;
      values.clear();
      if (!oi::decode_frame(decoder.frame(), values)) std::abort();
      (void)decoder.next();
    }
  }
  if (decoder.counters().frames == 0) std::abort();
}

// Estimator, read schedule, acceleration limit and controller.
void loop(long frames) {
  rt::WheelLoop wheels{{}};
  double sum = 0.0;
  for (long i = 0; i < frames; ++i) {
    wheels.frame(rt::WheelEstimator::Reading{.distance_mm = 3, .angle_deg = 0});
    sum += wheels.control({200.0, 200.0}).left_mm_s;
    (void)wheels.next_reads();
  }
  if (sum < 0.0) std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view part = argc == 3 ? argv[1] : "";
  const long frames = argc == 3 ? std::strtol(argv[2], nullptr, 10) : 0;
  if (part == "cycle") {
    cycle(frames);
  } else if (part == "echo") {
    echo(frames);
  } else if (part == "decode") {
    decode(frames);
  } else if (part == "loop") {
    loop(frames);
  } else {
    std::fputs("usage: cycle_cost cycle|echo|decode|loop FRAMES\n", stderr);
    return 2;
  }
  return 0;
}
