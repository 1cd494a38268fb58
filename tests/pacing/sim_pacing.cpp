// sim_pacing COUNT...: a minute of real time for each count, with that many virtual Creates in one
// process of `cargobay sim`, each streaming everything. Fails if one of them does not keep the
// robot's pace: 15 ms per frame on average, and no byte before the wire could have carried it.
// Their cost is printed, not judged: the machine may be shared.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "rt/kernel_file.hpp"
#include "tests/pty/command.hpp"
#include "tests/pty/serial_client.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using hal::sim::test::SerialClient;

constexpr std::size_t kFrameBytes = 56;  // packet 6, framed
constexpr double kBytesPerSecond = 5760.0;
constexpr double kPeriodS = 0.015;
constexpr double kTolerance = 0.001;
constexpr double kDurationS = 60.0;

double monotonic_s() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// CPU time of a process: fields 14 and 15 of its stat, whose second field may contain blanks.
double processor_s(pid_t process) {
  const std::string text = rt::kernel_file("/proc/" + std::to_string(process) + "/stat");
  std::istringstream fields{text.substr(text.rfind(')') + 1)};
  std::string passed_over;
  for (int i = 3; i < 14; ++i) fields >> passed_over;
  double user = 0.0;
  double system = 0.0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

class Stream {
 public:
  explicit Stream(const std::string& path) : client_{path}, asked_at_s_{monotonic_s()} {
    asked_ = client_.send({128, 148, 1, 6});
  }
  bool asked() const { return asked_; }
  int descriptor() const { return client_.descriptor(); }
  // Takes what is there.
  void read_all() {
    std::array<std::uint8_t, 4096> buffer{};
    const ssize_t count = read(client_.descriptor(), buffer.data(), buffer.size());
    if (count <= 0) return;
    const double now_s = monotonic_s();
    const std::size_t frames_before = frames();
    bytes_ += static_cast<std::size_t>(count);
    early_ = early_ || static_cast<double>(bytes_) > (now_s - asked_at_s_) * kBytesPerSecond;
    if (frames() == frames_before) return;
    if (frames_before == 0) {
      first_at_s_ = now_s;
      first_ = frames();
    }
    last_at_s_ = now_s;
  }
  std::size_t frames() const { return bytes_ / kFrameBytes; }
  bool early() const { return early_; }
  double period_s() const {
    return (last_at_s_ - first_at_s_) / static_cast<double>(frames() - first_);
  }

 private:
  SerialClient client_;
  double asked_at_s_;
  bool asked_ = false;
  double first_at_s_ = 0.0;  // when the first frame was complete
  double last_at_s_ = 0.0;
  std::size_t first_ = 0;
  std::size_t bytes_ = 0;
  bool early_ = false;
};

std::vector<std::string> announced(const std::string& out) {
  constexpr std::string_view kAnnouncement = "listening on ";
  std::vector<std::string> paths;
  std::istringstream lines{out};
  for (std::string line; std::getline(lines, line);)
    paths.push_back(line.substr(kAnnouncement.size()));
  return paths;
}

// Starts the command and asks each of its robots for its stream; empty if that fails.
std::vector<std::unique_ptr<Stream>> open_streams(Command& command, std::size_t count) {
  std::vector<std::unique_ptr<Stream>> streams;
  if (!eventually([&] { return !command.running() || announced(command.out()).size() == count; }))
    return {};
  for (const std::string& path : announced(command.out())) {
    streams.push_back(std::make_unique<Stream>(path));
    if (!streams.back()->asked()) return {};
  }
  return streams;
}

bool keep_their_pace(std::size_t count) {
  Command command{{"sim", "--count", std::to_string(count)}};
  const auto streams = open_streams(command, count);
  if (streams.size() != count) {
    std::fprintf(stderr, "no %zu robots: %s\n", count, command.err().c_str());
    return false;
  }
  const double processor_before_s = processor_s(command.process());
  const double begin_s = monotonic_s();
  while (monotonic_s() < begin_s + kDurationS) {
    poll(nullptr, 0, 5);  // the reader leaves the CPU to the robots
    for (const auto& stream : streams) stream->read_all();
  }
  const double elapsed_s = monotonic_s() - begin_s;
  const double share = (processor_s(command.process()) - processor_before_s) / elapsed_s;
  double worst = 0.0;
  bool early = false;
  for (const auto& stream : streams) {
    const double error = std::abs(stream->period_s() / kPeriodS - 1.0);
    worst = std::max(worst, std::isfinite(error) ? error : 1.0);
    early = early || stream->early();
  }
  std::printf("| %6zu | %8.2f %% | %8.1f %% | %11.4f %% | %-5s |\n", count,
              100.0 * share / static_cast<double>(count), 100.0 * share, 100.0 * worst,
              early ? "yes" : "none");
  std::fflush(stdout);
  command.send(SIGTERM);
  return worst <= kTolerance && !early && command.exit_code() == 0;
}

}  // namespace
}  // namespace cargobay::test

int main(int argc, char** argv) {
  std::printf(
      "| robots | a core each | together | worst period | early |\n|---|---|---|---|---|\n");
  bool kept = argc > 1;
  for (int i = 1; i < argc; ++i) {
    const std::size_t count = std::strtoul(argv[i], nullptr, 10);
    kept = cargobay::test::keep_their_pace(count) && kept;
  }
  return kept ? 0 : 1;
}
