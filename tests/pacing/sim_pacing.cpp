// A minute of real time: many virtual Creates in one process, each streaming all it has, each at
// the robot's pace. What they cost is printed, not judged: the machine may be shared.
#include <poll.h>

#include <array>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/server.hpp"
#include "tests/pty/serial_client.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this folder's own helpers

constexpr std::size_t kFrameBytes = 56;  // packet 6, framed
constexpr double kBytesPerSecond = 5760.0;
constexpr double kPeriodS = 0.015;
constexpr double kTolerance = 0.001;

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Served {
  std::unique_ptr<Server> server{};
  std::unique_ptr<SerialClient> client{};
  double asked_at_s = 0.0;
  double first_at_s = 0.0;  // when the first frame was whole
  double last_at_s = 0.0;
  std::size_t bytes = 0;
  bool early = false;

  // Takes what is there.
  void read_all() {
    std::array<std::uint8_t, 4096> buffer{};
    const ssize_t count = read(client->descriptor(), buffer.data(), buffer.size());
    if (count <= 0) return;
    const double now_s = seconds_of(CLOCK_MONOTONIC);
    const std::size_t frames_before = frames();
    bytes += static_cast<std::size_t>(count);
    early = early || static_cast<double>(bytes) > (now_s - asked_at_s) * kBytesPerSecond;
    if (frames() == frames_before) return;
    if (frames_before == 0) first_at_s = now_s;
    last_at_s = now_s;
  }
  std::size_t frames() const { return bytes / kFrameBytes; }
  double period_s() const {
    return (last_at_s - first_at_s) / (static_cast<double>(frames()) - 1.0);
  }
};

void serve_and_measure(std::size_t count, double duration_s) {
  std::vector<Served> robots(count);
  for (Served& robot : robots) {
    auto opened = Server::open({}, {});
    ASSERT_TRUE(opened);
    robot.server = std::move(*opened);
    ASSERT_FALSE(robot.server->start());
    robot.client = std::make_unique<SerialClient>(robot.server->path());
    robot.asked_at_s = seconds_of(CLOCK_MONOTONIC);
    ASSERT_TRUE(robot.client->send({128, 148, 1, 6}));
  }
  std::vector<pollfd> sources;
  sources.reserve(count);
  for (const Served& robot : robots) {
    sources.push_back({.fd = robot.client->descriptor(), .events = POLLIN, .revents = 0});
  }
  const double process_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  const double reader_s = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  const double begin_s = seconds_of(CLOCK_MONOTONIC);
  while (seconds_of(CLOCK_MONOTONIC) < begin_s + duration_s) {
    poll(sources.data(), sources.size(), 100);
    for (std::size_t i = 0; i < count; ++i) {
      if (sources[i].revents != 0) robots[i].read_all();
    }
  }
  const double elapsed_s = seconds_of(CLOCK_MONOTONIC) - begin_s;
  const double served_s = (seconds_of(CLOCK_PROCESS_CPUTIME_ID) - process_s) -
                          (seconds_of(CLOCK_THREAD_CPUTIME_ID) - reader_s);
  std::printf("%zu robots: %.2f %% of a core each, %.1f %% together\n", count,
              100.0 * served_s / elapsed_s / static_cast<double>(count),
              100.0 * served_s / elapsed_s);
  for (const Served& robot : robots) {
    EXPECT_NEAR(robot.period_s() / kPeriodS, 1.0, kTolerance);
    EXPECT_FALSE(robot.early);
    EXPECT_EQ(robot.server->snapshot().server.bytes_undelivered, 0U);
  }
}

TEST(ServerPacing, OfOneRobotIsExactOverAMinute) { serve_and_measure(1, 60.0); }

TEST(ServerPacing, OfThirtyTwoRobotsIsExactOverAMinute) { serve_and_measure(32, 60.0); }

}  // namespace
}  // namespace cargobay::hal::sim
