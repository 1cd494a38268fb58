// cycle_cost carried|lost PART FRAMES: drives a robot in memory for FRAMES frames, of the kind that
// carries the remainder of a reading or the kind that loses it, and keeps its readings; then does
// one part of the control cycle, or all of it, for the same frames again. Only the latter,
// measured(), counts. tests/jitter/cost.sh counts its instructions, and tests/pi/cycle_cost.py
// those of the kernel too. Parts: cycle and echo, in memory; pty_cycle and pty_echo, on a
// pseudo-terminal; decode; loop.

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/port/pty_transport.hpp"
#include "hal/stream/byte_stream.hpp"
#include "hal/stream/forwarding_stream.hpp"
#include "oi/encode.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/both_odometries.hpp"
#include "rt/wheel_loop.hpp"
#include "tests/jitter/memory_stream.hpp"

namespace {

using namespace cargobay;  // NOLINT(google-build-using-namespace): a program of its own

using test::MemoryStream;

// What each frame reported of the counters.
using Readings = std::vector<rt::WheelEstimator::Reading>;

// Not a whole number of mm per tick, so that it matters what happens to the remainder.
constexpr rt::WheelSpeeds kTarget{190.0, 190.0};

hal::ControlAnswer decide(void* /*context*/, const hal::CycleState& /*state*/, double /*seconds*/)
    CARGOBAY_NONBLOCKING {
  return kTarget;
}

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// The instruction counter finds it by its name. Prints the CPU time, which on a machine whose clock
// counts instructions is their number.
template <typename Work>
[[gnu::noinline]] void measured(std::size_t frames, const Work& work) {
  const double begin = thread_seconds();
  work();
  const double seconds = thread_seconds() - begin;
  std::printf("%.1f ns of the processor a frame\n", seconds * 1e9 / static_cast<double>(frames));
}

std::unique_ptr<hal::ControlCycle> make_cycle(hal::ByteStream& stream) {
  auto cycle = std::make_unique<hal::ControlCycle>(stream, hal::ControlCycle::Parameters{});
  cycle->set_control({.function = &decide});
  return cycle;
}

void cycle(hal::ByteStream& stream, std::size_t frames) {
  const auto cycle = make_cycle(stream);
  measured(frames, [&] { (void)cycle->run(); });
  if (cycle->frames().lost != 0 || cycle->withheld_commands() != 0) std::abort();
}

Readings readings_of_a_drive(MemoryStream& stream, std::size_t frames) {
  struct Kept {
    Readings readings;
    std::size_t count = 0;
  } kept{.readings = Readings(frames)};
  const auto cycle = make_cycle(stream);
  cycle->set_observer({.function =
                           [](void* context, const hal::CycleState& state) CARGOBAY_NONBLOCKING {
                             auto& all = *static_cast<Kept*>(context);
                             all.readings[all.count++] = state.reading;
                           },
                       .context = &kept});
  (void)cycle->run();
  if (kept.count != frames) std::abort();
  return kept.readings;
}

void echo(hal::ByteStream& known, std::size_t frames) {
  // Called as the cycle calls it: the compiler must not know which stream it is.
  hal::ByteStream* volatile unknown = &known;
  hal::ByteStream& stream = *unknown;
  const auto command = *oi::encode(oi::DriveDirect{.left = {}, .right = {}});
  std::array<std::uint8_t, 1024> bytes{};
  measured(frames, [&] {
    while (stream.wait(rt::TimePoint::max()) == hal::ByteStream::Wait::ready) {
      (void)stream.read(bytes);
      (void)stream.write(command);
    }
  });
}

// A pseudo-terminal on the robot's clock: 15 ms pass with each frame. When asked for the time it
// also reads its own clock, for the cost of that.
class PtyOnRobotTime final : public hal::ForwardingStream {
 public:
  PtyOnRobotTime(hal::ByteStream& port, const MemoryStream& robot)
      : ForwardingStream{port}, robot_{robot} {}

  Wait wait(rt::TimePoint /*deadline*/) CARGOBAY_NONBLOCKING override {
    return stream().wait(stream().now() + std::chrono::seconds{10});
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override {
    (void)stream().now();
    return robot_.now();  // the robot stands still meanwhile: it waits for the answer
  }

 private:
  const MemoryStream& robot_;
};

// Sends the next frame when the last one has been answered.
void serve(int master, MemoryStream& robot) {
  std::array<std::uint8_t, 256> bytes{};
  while (robot.wait({}) == hal::ByteStream::Wait::ready) {
    const std::size_t frame = robot.read(bytes).count;
    if (::write(master, bytes.data(), frame) != static_cast<ssize_t>(frame)) std::abort();
    const ssize_t count = ::read(master, bytes.data(), bytes.size());
    if (count <= 0) std::abort();
    (void)robot.write(std::span{bytes}.first(static_cast<std::size_t>(count)));
  }
  close(master);
}

void on_pty(void (*part)(hal::ByteStream&, std::size_t), MemoryStream& robot, std::size_t frames) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::array<char, 64> path{};
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) std::abort();
  if (ptsname_r(master, path.data(), path.size()) != 0) std::abort();
  hal::Result<std::unique_ptr<hal::ByteStream>> port = hal::open_pty(path.data(), robot.baud());
  if (!port) {
    std::fprintf(stderr, "%s\n", port.failure().message.c_str());
    std::abort();
  }
  (void)(*port)->set_wake_threshold(oi::kCreate.frame_bytes);
  PtyOnRobotTime stream{**port, robot};
  std::thread server{serve, master, std::ref(robot)};
  part(stream, frames);
  server.join();
}

void decode(const Readings& readings) {
  const auto reading_frame = hal::jitter::sample_frame(hal::FrameList::reading);
  const auto hazards_frame = hal::jitter::sample_frame(hal::FrameList::hazards);
  oi::StreamDecoder decoder;
  oi::SensorValues values;
  measured(readings.size(), [&] {
    for (const auto& reading : readings) {
      decoder.push(reading.axes().any() ? reading_frame : hazards_frame,
                   [&](oi::StreamDecoder::Outcome) {
                     values.clear();
                     if (!oi::decode_frame(decoder.frame(), values)) std::abort();
                   });
    }
  });
  if (decoder.counters().frames == 0) std::abort();
}

// Estimator with its odometry, read schedule, acceleration limit and controller.
void loop(const Readings& readings) {
  rt::WheelLoop wheels{{}};
  rt::BothOdometries odometry{{}};
  double sum = 0.0;
  measured(readings.size(), [&] {
    for (const auto& reading : readings) {
      wheels.frame(reading);
      odometry.step(wheels.take_travels(), wheels.belief(), wheels.sure());
      sum += odometry.now().covariance().xx;
      sum += wheels.estimate().left_mm_s + wheels.control(kTarget).left_mm_s;
      (void)wheels.next_reads();
    }
  });
  if (std::isnan(sum)) std::abort();
}

int usage() {
  std::fputs("usage: cycle_cost carried|lost cycle|echo|pty_cycle|pty_echo|decode|loop FRAMES\n",
             stderr);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view kind = argc == 4 ? argv[1] : "";
  const long frames = argc == 4 ? std::strtol(argv[3], nullptr, 10) : 0;
  if ((kind != "carried" && kind != "lost") || frames <= 0) return usage();
  const auto remainder = kind == "carried" ? rt::Remainder::carried : rt::Remainder::lost;
  MemoryStream first{frames, remainder};
  const Readings readings = readings_of_a_drive(first, static_cast<std::size_t>(frames));
  MemoryStream stream{frames, remainder};
  const std::string_view part = argv[2];
  const std::size_t count = readings.size();
  if (part == "cycle") {
    cycle(stream, count);
  } else if (part == "echo") {
    echo(stream, count);
  } else if (part == "pty_cycle") {
    on_pty(&cycle, stream, count);
  } else if (part == "pty_echo") {
    on_pty(&echo, stream, count);
  } else if (part == "decode") {
    decode(readings);
  } else if (part == "loop") {
    loop(readings);
  } else {
    return usage();
  }
  return 0;
}
