// soak [--frames N] [--seconds N]: N frames in virtual time, on a line that damages some of them,
// then N seconds of real time over a pseudo-terminal (10^6 and 60 by default). Once warm, resident
// memory and open descriptors must not grow, and each frame that the robot sent must be counted
// once. Prints a line of docs/reliability.md for each; the exit status is 1 if something does not
// hold.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_outlets.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/port/open_port.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "oi/dialect.hpp"
#include "rt/unchecked.hpp"
#include "tests/campaign/number.hpp"

namespace cargobay::campaign {
namespace {

// Of resident memory, once warm. The kernel reports it to within 32 pages per processor.
constexpr long kMostGrowthKib = 512;

// The most and the least that the process has held since the first look.
class Holdings {
 public:
  void look() {
    long pages = 0;
    long resident = 0;
    std::ifstream{"/proc/self/statm"} >> pages >> resident;
    const long kib = resident * (sysconf(_SC_PAGESIZE) / 1024);
    const std::filesystem::directory_iterator descriptors{"/proc/self/fd"};
    const long open = std::distance(begin(descriptors), end(descriptors));
    least_kib_ = std::min(least_kib_, kib);
    most_kib_ = std::max(most_kib_, kib);
    least_open_ = std::min(least_open_, open);
    most_open_ = std::max(most_open_, open);
  }
  bool flat() const {
    return most_kib_ - least_kib_ <= kMostGrowthKib && most_open_ == least_open_;
  }
  void print() const {
    std::printf(" %ld to %ld KiB | %ld to %ld |", least_kib_, most_kib_, least_open_, most_open_);
  }

 private:
  long least_kib_ = std::numeric_limits<long>::max();
  long most_kib_ = 0;
  long least_open_ = std::numeric_limits<long>::max();
  long most_open_ = 0;
};

// Frames that the robot sent and the cycle has not counted: at each answer, those that were in
// flight before the first, plus late ones. So the least over a while is the same at the beginning
// and at the end if, and only if, each frame in between was counted once.
class Ledger {
 public:
  // The control thread calls it at each answer.
  void book(std::uint64_t sent, const hal::FrameCounters& counted) CARGOBAY_NONBLOCKING {
    const auto open = static_cast<std::int64_t>(sent) -
                      static_cast<std::int64_t>(counted.good + counted.bad + counted.lost);
    if (answers_ < kWhile) first_ = std::min(first_, open);
    if (answers_ % kWhile == 0) {
      last_ = current_;
      current_ = open;
    }
    current_ = std::min(current_, open);
    ++answers_;
  }
  std::int64_t uncounted() const { return std::min(last_, current_) - first_; }

 private:
  static constexpr std::uint64_t kWhile = 100;
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  std::uint64_t answers_ = 0;
  std::int64_t first_ = kNone;
  std::int64_t current_ = kNone;  // in this interval
  std::int64_t last_ = kNone;     // in the previous one
};

// Never at rest for long: stands, turns, drives both ways.
rt::WheelSpeeds speeds(double seconds) CARGOBAY_NONBLOCKING {
  switch (static_cast<std::int64_t>(seconds / 2.0) % 4) {
    case 0: return {200.0, 200.0};
    case 1: return {-100.0, 100.0};
    case 2: return {-300.0, -150.0};
    default: return {};
  }
}

bool print_end(const char* what, const hal::FrameCounters& frames, const Ledger& ledger,
               const Holdings& holdings) {
  std::printf(
      "| %s | %llu | %llu | %llu | %lld |", what, static_cast<unsigned long long>(frames.good),
      static_cast<unsigned long long>(frames.bad), static_cast<unsigned long long>(frames.lost),
      static_cast<long long>(ledger.uncounted()));
  holdings.print();
  std::printf("\n");
  return ledger.uncounted() == 0 && holdings.flat();
}

class VirtualSoak {
 public:
  explicit VirtualSoak(std::uint64_t frames) : frames_{frames} {}

  bool run() {
    if (!hal::bring_up(link_, {.packets = oi::kCreate.list(oi::FrameList::reading)})) return false;
    if (link_.set_wake_threshold(oi::kCreate.frame_bytes)) return false;
    cycle_ = std::make_unique<hal::ControlCycle>(link_, hal::ControlCycle::Parameters{});
    cycle_->set_control({.function = &VirtualSoak::control, .context = this});
    const bool asked = cycle_->run() == hal::CycleEnd::asked;
    return print_end("virtual time", cycle_->frames(), ledger_, holdings_) && asked;
  }

 private:
  static constexpr std::uint64_t kLooks = 50;

  static hal::ControlAnswer control(void* context, const hal::CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    // In virtual time nothing waits for these allocations.
    rt::unchecked([context] { static_cast<VirtualSoak*>(context)->answer(); });
    return speeds(seconds);
  }
  void answer() {
    const std::uint64_t sent = device_.counters().frames_sent;
    ledger_.book(sent, cycle_->frames());
    const bool clean = sent < 200 || sent + 200 > frames_;
    link_.cable().faults_to_host().bytes.flipped = clean ? 0.0 : 0.0005;
    link_.cable().faults_to_host().bytes.lost = clean ? 0.0 : 0.0005;
    const bool warm = ++answers_ > frames_ / 5;
    if (warm && answers_ % std::max<std::uint64_t>(1, frames_ / kLooks) == 0) holdings_.look();
    if (sent >= frames_) cycle_->request_stop();
  }

  std::uint64_t frames_;
  std::uint64_t answers_ = 0;
  hal::sim::Device device_{hal::sim::Parameters{}};
  hal::sim::VirtualLink link_{device_};
  std::unique_ptr<hal::ControlCycle> cycle_{};
  Ledger ledger_{};
  Holdings holdings_{};
};

class RealSoak {
 public:
  explicit RealSoak(std::uint64_t seconds) : seconds_{seconds} {}

  bool run() {
    hal::sim::ServerOptions options;
    options.priority = kServerPriority;
    options.on_tick = [this](const hal::sim::Device& robot) {
      sent_.store(robot.counters().frames_sent, std::memory_order_relaxed);
    };
    const auto server = hal::sim::Server::open({}, options);
    if (!server || (*server)->start()) return failed("the virtual Create does not start");
    auto port = hal::open_port((*server)->path(), oi::kCreate.default_baud);
    if (!port) return failed(port.failure().message);
    auto robot = hal::Robot::open(std::move(port->stream), {});
    if (!robot) return failed(robot.failure().message);
    cycle_ = &(*robot)->cycle();
    const auto grant = (*robot)->start({.function = &RealSoak::control, .context = this});
    if (!grant) return failed(grant.failure().message);
    watch(**robot);
    const auto farewell = (*robot)->stop();
    if (farewell.end != hal::CycleEnd::asked) return failed(hal::explain(farewell));
    return print_end("real time", cycle_->frames(), ledger_, holdings_) &&
           farewell.robot.standing();
  }

 private:
  static constexpr int kServerPriority = 85;  // above the control thread's: a robot has its own CPU
  static constexpr std::uint64_t kWarm = 5;   // seconds

  static bool failed(const std::string& why) {
    std::fprintf(stderr, "soak: %s\n", why.c_str());
    return false;
  }
  static hal::ControlAnswer control(void* context, const hal::CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<RealSoak*>(context);
    self.ledger_.book(self.sent_.load(std::memory_order_relaxed), self.cycle_->frames());
    return speeds(seconds);
  }
  void watch(const hal::Robot& robot) {
    for (std::uint64_t second = 0; second < seconds_ && !robot.ended(); ++second) {
      poll(nullptr, 0, 1000);
      if (second >= kWarm) holdings_.look();
    }
  }

  std::uint64_t seconds_;
  std::atomic<std::uint64_t> sent_{0};
  hal::ControlCycle* cycle_ = nullptr;
  Ledger ledger_{};
  Holdings holdings_{};
};

struct Lengths {
  std::uint64_t frames = 1'000'000;
  std::uint64_t seconds = 60;
};

std::optional<Lengths> parse(int count, char** words) {
  Lengths lengths;
  for (int i = 1; i < count; i += 2) {
    if (i + 1 == count) return std::nullopt;
    const std::string_view option{words[i]};
    const auto value = number(words[i + 1]);
    if (!value || (option != "--frames" && option != "--seconds")) return std::nullopt;
    (option == "--frames" ? lengths.frames : lengths.seconds) = *value;
  }
  return lengths;
}

// Whether all of it held.
bool soak(const Lengths& lengths) {
  std::printf("| | good | bad | lost | not counted | resident memory | descriptors |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const bool in_virtual_time =
      lengths.frames == 0 || std::make_unique<VirtualSoak>(lengths.frames)->run();
  std::fflush(stdout);
  const bool in_real_time =
      lengths.seconds == 0 || std::make_unique<RealSoak>(lengths.seconds)->run();
  return in_virtual_time && in_real_time;
}

}  // namespace
}  // namespace cargobay::campaign

int main(int argc, char** argv) {
  const auto lengths = cargobay::campaign::parse(argc, argv);
  if (!lengths) {
    std::fprintf(stderr, "usage: soak [--frames N] [--seconds N]\n");
    return 2;
  }
  return cargobay::campaign::soak(*lengths) ? 0 : 1;
}
