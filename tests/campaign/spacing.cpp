// spacing [--bytes N]: a client at 115200 baud on a pseudo-terminal. First it sends commands in one
// write each, as most published clients do; a robot loses bytes that follow too closely (OI p. 7).
// Then, while every processor is busy, it sends N bytes one by one, each 200 us after the last was
// written, none of which the virtual Create may lose; then commands in one write again, all of
// which it may hear: in doubt, a byte is heard. Prints a line of docs/virtual-create.md for each;
// the exit status is 1 if a spaced byte is lost or, on the idle machine, none of the others.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <thread>
#include <vector>

#include "hal/sim/line/server.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"
#include "tests/campaign/number.hpp"

namespace cargobay::campaign {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kBaud = 115200;
constexpr std::uint64_t kInOneWrite = 200;                        // commands
constexpr std::array<std::uint8_t, 2> kBeginning{128, 131};       // Start, Safe
constexpr std::array<std::uint8_t, 5> kCommand{145, 0, 0, 0, 0};  // Drive Direct

void sleep_for(rt::Duration duration) {
  const timespec pause = rt::as_timespec(duration);
  nanosleep(&pause, nullptr);
}

// Two busy threads per processor.
class Load {
 public:
  Load() {
    for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i) {
      threads_.emplace_back([this] {
        while (!over_.load(std::memory_order_relaxed)) {
        }
      });
    }
  }
  ~Load() {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  std::atomic<bool> over_{false};
  std::vector<std::thread> threads_{};
};

class Client {
 public:
  // Switches a robot on at that rate, and opens its port.
  Client() {
    hal::sim::Parameters parameters;
    parameters.boot_baud = kBaud;
    auto server = hal::sim::Server::open(parameters, {});
    if (!server || (*server)->start()) return;
    server_ = std::move(*server);
    port_ = ::open(server_->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    sleep_for(milliseconds{100});
  }
  ~Client() {
    if (port_ >= 0) close(port_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool write(std::span<const std::uint8_t> bytes) {
    return ::write(port_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  }
  // The next byte may begin after that, whenever this one began.
  bool write_spaced(std::uint8_t byte) {
    const bool written = write(std::span{&byte, 1});
    const rt::TimePoint next = rt::Clock::now() + oi::kByteSpacingAt115200;
    sleep_for(oi::kByteSpacingAt115200);
    while (rt::Clock::now() < next) {
    }
    return written;
  }

  // Into Safe mode.
  bool begin() {
    for (const std::uint8_t command : kBeginning) {
      if (port_ < 0 || !write_spaced(command)) return false;
      sleep_for(milliseconds{30});
    }
    return true;
  }
  // Once everything written has arrived.
  hal::sim::DeviceCounters counters(std::uint64_t received) const {
    constexpr int kMostLooks = 1000;
    hal::sim::DeviceCounters counters{};
    for (int i = 0; i < kMostLooks && counters.bytes_received < received; ++i) {
      sleep_for(milliseconds{10});
      counters = server_->snapshot().device;
    }
    return counters;
  }

 private:
  std::unique_ptr<hal::sim::Server> server_{};
  int port_ = -1;
};

bool report(std::string_view what, std::uint64_t written,
            const hal::sim::DeviceCounters& counters) {
  std::printf("| %s | %llu | %llu | %llu | %llu |\n", std::string{what}.c_str(),
              static_cast<unsigned long long>(written),
              static_cast<unsigned long long>(counters.bytes_received),
              static_cast<unsigned long long>(counters.bytes_unheard),
              static_cast<unsigned long long>(counters.commands));
  return counters.bytes_received == written;
}

bool spaced(std::uint64_t bytes) {
  Client client;
  if (!client.begin()) return false;
  for (std::uint64_t i = kBeginning.size(); i < bytes; ++i) {
    if (!client.write_spaced(kCommand[(i - kBeginning.size()) % kCommand.size()])) return false;
  }
  const hal::sim::DeviceCounters counters = client.counters(bytes);
  return report("one by one, 200 us apart, busy", bytes, counters) && counters.bytes_unheard == 0;
}

// Whether some were lost.
bool in_one_write(std::string_view what) {
  Client client;
  if (!client.begin()) return false;
  for (std::uint64_t i = 0; i < kInOneWrite; ++i) {
    if (!client.write(kCommand)) return false;
    sleep_for(milliseconds{15});
  }
  const std::uint64_t written = kBeginning.size() + kInOneWrite * kCommand.size();
  const hal::sim::DeviceCounters counters = client.counters(written);
  return report(what, written, counters) && counters.bytes_unheard > 0;
}

int run(std::uint64_t bytes) {
  std::puts("| written | bytes | arrived | lost | commands |\n|---|---|---|---|---|");
  const bool some_lost = in_one_write("a command in one write");
  const Load load;
  const bool none_lost = spaced(bytes);
  (void)in_one_write("a command in one write, busy");
  return some_lost && none_lost ? 0 : 1;
}

}  // namespace
}  // namespace cargobay::campaign

int main(int count, char** words) {
  const std::span<char*> arguments{words, static_cast<std::size_t>(count)};
  std::optional<std::uint64_t> bytes;
  if (arguments.size() == 1) bytes = 1'000'000;
  if (arguments.size() == 3 && std::string_view{arguments[1]} == "--bytes")
    bytes = cargobay::campaign::number(arguments[2]);
  if (bytes.value_or(0) > 0) return cargobay::campaign::run(*bytes);
  std::fputs("usage: spacing [--bytes N]\n", stderr);
  return 2;
}
