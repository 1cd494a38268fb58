// Any bytes at any time and rate, with any sensor input and any fault of the line: the virtual
// Create goes on, keeps its promises, and after a power cycle works as on its first day.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <source_location>
#include <span>
#include <string>
#include <vector>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/remote/control.hpp"
#include "oi/dialect.hpp"

namespace {

using namespace cargobay;            // NOLINT(google-build-using-namespace): one program
using namespace cargobay::hal::sim;  // NOLINT(google-build-using-namespace): its subject

void require(bool condition, std::source_location where = std::source_location::current()) {
  if (condition) return;
  std::fprintf(stderr, "line %u is broken\n", static_cast<unsigned>(where.line()));
  std::abort();
}

constexpr std::array<const char*, 24> kLines{"power",
                                             "press play",
                                             "press advance 50",
                                             "bump left",
                                             "bump none",
                                             "wheeldrop left on",
                                             "wheeldrop left off",
                                             "cliff front_left on",
                                             "cliff front_left off",
                                             "charger on",
                                             "charger off",
                                             "home-base on",
                                             "brc low",
                                             "brc high",
                                             "battery 0",
                                             "place 10 20 30",
                                             "fault lost 0.2 both",
                                             "fault duplicated 0.2 both",
                                             "fault jitter 30",
                                             "fault burst on",
                                             "fault half-command",
                                             "fault brown-out",
                                             "fault text x",
                                             "fault none"};

class Schedule {
 public:
  Schedule(const Parameters& parameters, std::span<const std::uint8_t> input)
      : device_{parameters}, link_{device_}, input_{input} {}

  void run() {
    while (!input_.empty() && steps_++ < kMostSteps) {
      step(take());
      check();
    }
    revive();
  }

 private:
  static constexpr int kMostSteps = 4096;

  std::uint8_t take() {
    if (input_.empty()) return 0;
    const std::uint8_t byte = input_.front();
    input_ = input_.subspan(1);
    return byte;
  }

  void step(std::uint8_t choice) {
    if (choice < 128) {  // this many bytes, back to back
      const std::size_t count = std::min<std::size_t>(choice % 16 + 1, input_.size());
      (void)link_.write(input_.first(count));
      input_ = input_.subspan(count);
    } else if (choice < 192) {
      link_.advance(std::chrono::microseconds{200} * (choice - 127));
    } else if (choice < 208) {
      link_.advance(std::chrono::milliseconds{100} * (choice - 191));
    } else if (choice < 220) {
      (void)link_.set_baud(oi::kCreate.baud_rates[static_cast<std::size_t>(choice - 208)]);
    } else if (choice == 220) {
      (void)link_.set_baud(1U + take());
    } else {
      const std::string answer =
          control(kLines[static_cast<std::size_t>(choice - 221) % kLines.size()], link_.cable());
      require(answer == "ok");
    }
  }

  void check() {
    require(device_.until_next_event() >= rt::Duration{0});
    require(device_.until_next_event() <= oi::kTick);
    const WheelSpeeds commanded = device_.commanded();
    require(std::abs(commanded.left_mm_s) <= 500.0 && std::abs(commanded.right_mm_s) <= 500.0);
    const bool controlled = device_.mode() == oi::Mode::safe || device_.mode() == oi::Mode::full;
    const bool drives = commanded.left_mm_s != 0.0 || commanded.right_mm_s != 0.0;
    require(!drives || controlled || device_.demos().running());
    require(device_.power() == Power::on || device_.mode() == oi::Mode::off);
    require(link_.cable().available() <= Cable::kHostRoom);
    std::array<std::uint8_t, 64> bytes{};
    while (link_.read(bytes).count != 0) {
    }
  }

  void revive() {
    device_.inputs() = {};
    device_.battery().set_charge_mah(2000.0);
    require(control("fault none", link_.cable()) == "ok");
    if (device_.power() == Power::off) device_.press_power();
    device_.brown_out();  // what waits to be sent is forgotten too
    (void)link_.set_baud(oi::kCreate.default_baud);
    link_.advance(std::chrono::seconds{4});
    link_.discard_input();
    const std::array<std::uint8_t, 1> start{128};
    const std::array<std::uint8_t, 1> sensors{142};
    const std::array<std::uint8_t, 1> packet{35};
    for (const auto& byte : {start, sensors, packet}) {
      (void)link_.write(byte);
      link_.advance(std::chrono::milliseconds{100});  // 115200 needs a gap, 300 the time
    }
    link_.advance(std::chrono::milliseconds{100});
    std::array<std::uint8_t, 64> bytes{};
    require(link_.read(bytes).count == 1 && bytes[0] == 1);
  }

  Device device_;
  VirtualLink link_;
  std::span<const std::uint8_t> input_;
  int steps_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Parameters parameters;
  parameters.remainder = (data[0] & 1U) != 0 ? Remainder::lost : Remainder::carried;
  parameters.dialect = (data[0] & 2U) != 0 ? &oi::kCreateWithExtensions : &oi::kCreate;
  parameters.power_on = (data[0] & 4U) != 0 ? PowerOn::now : PowerOn::long_ago;
  Schedule{parameters, {data + 1, size - 1}}.run();
  return 0;
}
