// cycle_cost PART FRAMES: does one part of the control cycle, or all of it, for so many frames, on
// a stream in memory. tests/jitter/cost.sh counts the instructions. Parts: cycle, echo, decode,
// loop.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "hal/byte_stream.hpp"
#include "hal/control_cycle.hpp"
#include "oi/encode.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/odometry.hpp"
#include "rt/wheel_loop.hpp"
#include "tests/jitter/memory_stream.hpp"

namespace {

using namespace cargobay;  // NOLINT(google-build-using-namespace): a program of its own

using test::MemoryStream;

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
  const auto frame = hal::jitter::sample_frame(hal::FrameList::reading);
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

// Estimator with its odometry, read schedule, acceleration limit and controller.
void loop(long frames) {
  rt::WheelLoop wheels{{}};
  rt::Odometry odometry{{}};
  double sum = 0.0;
  for (long i = 0; i < frames; ++i) {
    wheels.frame(rt::WheelEstimator::Reading{.distance_mm = 3, .angle_deg = 0});
    sum += wheels.control({200.0, 200.0}).left_mm_s;
    (void)wheels.next_reads();
    odometry.step(wheels.take_travel());
    sum += odometry.covariance()[0];
  }
  if (std::isnan(sum)) std::abort();
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
