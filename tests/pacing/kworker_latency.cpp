// kworker_latency [SECONDS]: how long a byte takes from its writer to a reader at SCHED_FIFO 80,
// through a pipe, through a pseudo-terminal, and through one with the kworkers raised
// (hal/machine/kworker_boost.hpp): on an idle machine, while a program at SCHED_FIFO 10 takes 60 %
// of every CPU, and while ordinary programs, one more than there are CPUs, take all of them. The
// ways take turns in one run, so that they see the same machine; SECONDS of each, 10 by default.
// Prints a table; judges nothing. Needs root or CAP_SYS_NICE.
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "hal/machine/kworker_boost.hpp"
#include "rt/clock.hpp"
#include "rt/histogram.hpp"

namespace cargobay::test {
namespace {

using std::chrono::milliseconds;

constexpr int kReaderPriority = 80;
constexpr int kHogPriority = 10;
constexpr rt::Duration kHogPeriod = milliseconds{10};
constexpr rt::Duration kHogWorks = milliseconds{6};
constexpr rt::Duration kBytePeriod = milliseconds{5};
constexpr int kTurns = 10;

bool make_fifo(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

void sleep_until(rt::TimePoint time) {
  const std::int64_t ns = rt::nanoseconds(time);
  const timespec at{.tv_sec = static_cast<time_t>(ns / 1'000'000'000),
                    .tv_nsec = static_cast<long>(ns % 1'000'000'000)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

// A channel of bytes within this process.
struct Channel {
  int in = -1;
  int out = -1;
  int spare = -1;  // kept open

  Channel() = default;
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  ~Channel() {
    for (const int descriptor : {in, out, spare}) {
      if (descriptor >= 0) close(descriptor);
    }
  }
  bool open_pipe() {
    std::array<int, 2> ends{-1, -1};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    out = ends[0];
    in = ends[1];
    return true;
  }
  // Like a robot's: written at the master, read at the slave.
  bool open_terminal() {
    in = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    std::array<char, 64> path{};
    if (in < 0 || grantpt(in) != 0 || unlockpt(in) != 0 ||
        ptsname_r(in, path.data(), path.size()) != 0) {
      return false;
    }
    out = open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    if (out < 0 || tcgetattr(out, &settings) != 0) return false;
    cfmakeraw(&settings);
    return tcsetattr(out, TCSANOW, &settings) == 0;
  }
};

// What competes for the CPUs.
enum class Busy : std::uint8_t { nobody, realtime, ordinary };

// Real-time: one thread per CPU that works six tenths of the time. Ordinary: one thread more than
// there are CPUs, working all the time.
class Hogs {
 public:
  explicit Hogs(Busy kind) {
    const auto cpus = std::max(1U, std::thread::hardware_concurrency());
    if (kind == Busy::realtime)
      for (unsigned cpu = 0; cpu < cpus; ++cpu) threads_.emplace_back([this, cpu] { work(cpu); });
    if (kind == Busy::ordinary)
      for (unsigned i = 0; i <= cpus; ++i) threads_.emplace_back([this] { work_on(); });
  }
  ~Hogs() {
    ending_.store(true, std::memory_order_relaxed);
    for (std::thread& thread : threads_) thread.join();
  }
  Hogs(const Hogs&) = delete;
  Hogs& operator=(const Hogs&) = delete;

 private:
  void work(unsigned cpu) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    pthread_setaffinity_np(pthread_self(), sizeof set, &set);
    if (!make_fifo(kHogPriority)) return;
    rt::TimePoint begin = rt::Clock::now();
    while (!ending_.load(std::memory_order_relaxed)) {
      while (rt::Clock::now() < begin + kHogWorks) {
      }
      begin = std::max(begin + kHogPeriod, rt::Clock::now());
      sleep_until(begin);
    }
  }

  void work_on() const {
    while (!ending_.load(std::memory_order_relaxed)) continue;
  }

  std::atomic<bool> ending_{false};
  std::vector<std::thread> threads_;
};

// Sends a byte now and then for `duration`, and records how long each is in flight. Both ends have
// the reader's priority, so what is measured lies between them. The next byte goes out after the
// last has arrived, so a late one delays none.
void measure(const Channel& channel, rt::Duration duration, rt::Histogram& latency_ns) {
  std::atomic<std::int64_t> sent_ns{0};
  std::atomic<bool> under_way{false};
  std::thread reader{[&] {
    make_fifo(kReaderPriority);
    std::uint8_t byte = 1;
    while (byte != 0) {
      pollfd port{.fd = channel.out, .events = POLLIN, .revents = 0};
      if (ppoll(&port, 1, nullptr, nullptr) <= 0 || read(channel.out, &byte, 1) != 1) break;
      const std::int64_t now_ns = rt::nanoseconds(rt::Clock::now());
      latency_ns.record(
          static_cast<std::uint64_t>(now_ns - sent_ns.load(std::memory_order_acquire)));
      under_way.store(false, std::memory_order_release);
    }
  }};
  std::thread writer{[&] {
    make_fifo(kReaderPriority);
    const rt::TimePoint end = rt::Clock::now() + duration;
    rt::TimePoint next = rt::Clock::now();
    for (bool last = false; !last;) {
      next += kBytePeriod + std::chrono::microseconds{37};  // out of step with the hogs
      next = std::max(next, rt::Clock::now());
      sleep_until(next);
      if (under_way.load(std::memory_order_acquire)) continue;
      last = rt::Clock::now() >= end;
      const std::uint8_t byte = last ? 0 : 1;
      under_way.store(true, std::memory_order_release);
      sent_ns.store(rt::nanoseconds(rt::Clock::now()), std::memory_order_release);
      if (write(channel.in, &byte, 1) != 1) break;
    }
  }};
  writer.join();
  reader.join();
}

struct Way {
  const char* name = "";
  bool terminal = false;
  bool boosted = false;
  Busy busy = Busy::nobody;
  rt::Histogram latency_ns{};
};

bool measure(Way& way, rt::Duration duration) {
  Channel channel;
  if (!(way.terminal ? channel.open_terminal() : channel.open_pipe())) return false;
  hal::KworkerBoost boost{hal::kworker_priority(kReaderPriority)};
  if (way.boosted) {
    if (const std::error_code error = boost.start()) {
      std::fprintf(stderr, "%s\n", hal::explain_kworker_boost(error).c_str());
      return false;
    }
  }
  const Hogs hogs{way.busy};
  measure(channel, duration, way.latency_ns);
  return true;
}

bool measure_all(double seconds) {
  std::array<Way, 9> ways{{{"pipe, nobody in the way", false, false, Busy::nobody},
                           {"terminal, nobody in the way", true, false, Busy::nobody},
                           {"pipe, real-time program", false, false, Busy::realtime},
                           {"terminal, real-time program", true, false, Busy::realtime},
                           {"the same, kworkers raised", true, true, Busy::realtime},
                           {"terminal, real-time program again", true, false, Busy::realtime},
                           {"pipe, ordinary programs", false, false, Busy::ordinary},
                           {"terminal, ordinary programs", true, false, Busy::ordinary},
                           {"the same, kworkers raised", true, true, Busy::ordinary}}};
  const auto turn =
      std::chrono::duration_cast<rt::Duration>(std::chrono::duration<double>{seconds / kTurns});
  for (int i = 0; i < kTurns; ++i) {
    for (Way& way : ways) {
      if (!measure(way, turn)) return false;
    }
  }
  std::printf("| way of a byte | bytes | p50 us | p99 us | max us |\n|---|---|---|---|---|\n");
  for (const Way& way : ways) {
    const auto us = [](std::uint64_t ns) { return static_cast<double>(ns) / 1000.0; };
    std::printf("| %-33s | %6llu | %8.0f | %8.0f | %8.0f |\n", way.name,
                static_cast<unsigned long long>(way.latency_ns.count()),
                us(way.latency_ns.percentile(50)), us(way.latency_ns.percentile(99)),
                us(way.latency_ns.max()));
  }
  return true;
}

}  // namespace
}  // namespace cargobay::test

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::strtod(argv[1], nullptr) : 10.0;
  if (!(seconds > 0.0)) {
    std::fprintf(stderr, "usage: kworker_latency [SECONDS]\n");
    return 2;
  }
  return cargobay::test::measure_all(seconds) ? 0 : 1;
}
