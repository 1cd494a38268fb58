// `cargobay drive --reconnect`, while its robot's adapter is pulled out and plugged in again.

#include <poll.h>

#include <csignal>
#include <cstdio>
#include <ctime>

#include <nlohmann/json.hpp>

#include "drive_fixture.hpp"
#include "hal/feed/feed_place.hpp"
#include "hal/feed/feed_reader.hpp"

namespace cargobay::test {
namespace {

using nlohmann::json;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

double seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// CPU time of another process, over all its threads.
double processor_s(pid_t process) {
  clockid_t clock{};
  return clock_getcpuclockid(process, &clock) == 0 ? seconds(clock) : 0.0;
}

// The robot is known by a link, which leads to another pseudo-terminal after each unplugging.
class DriveReconnectTest : public DriveTest {
 protected:
  void SetUp() override {
    auto server = hal::sim::Server::open({}, {.link = folder_.path("robot")});
    ASSERT_TRUE(server) << server.failure().message;
    server_ = std::move(*server);
    ASSERT_FALSE(server_->start());
    port_ = folder_.path("robot");
  }

  static bool waits(Command& command, std::size_t times = 1) {
    return eventually([&] {
             return !command.running() ||
                    lines(command.err(), "the port hung up; waiting") >= times;
           }) &&
           command.running();
  }
  static bool is_back(Command& command, std::size_t times = 1) {
    return eventually(
               [&] { return !command.running() || lines(command.err(), "back after") >= times; }) &&
           command.running();
  }
  static std::size_t lines(const std::string& text, const std::string& saying) {
    std::size_t count = 0;
    for (std::size_t at = text.find(saying); at != std::string::npos;
         at = text.find(saying, at + 1))
      ++count;
    return count;
  }
  void replug() { EXPECT_TRUE(server_->replug()); }

  TemporaryFolder folder_;
};

TEST_F(DriveReconnectTest, RecordsAllLinksInOneMcap) {
  const std::string file = folder_.path("drive.mcap");
  Command command{drive({"--duration", "2", "--reconnect=20", "--record", file})};
  ASSERT_TRUE(starts_to_move());
  server_->unplug();
  ASSERT_TRUE(waits(command));
  replug();
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_FALSE(std::filesystem::exists(file + ".2"));
  const std::string bytes = contents(file);
  EXPECT_THAT(bytes, testing::EndsWith("MCAP0\r\n"));
  EXPECT_GT(lines(bytes, R"("covariance":{"xx_mm2")"), 100U) << "2 s of both links together";
  EXPECT_GT(lines(bytes, R"("tick":120,)"), 0U) << "they are counted on";
}

TEST_F(DriveReconnectTest, CarriesOnWhereItWas) {
  Command command{
      drive({"--duration", "2", "--reconnect=20", "--json", folder_.path("results.json")})};
  ASSERT_TRUE(starts_to_move());
  server_->unplug();
  ASSERT_TRUE(waits(command));
  replug();
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(lines(command.err(), "back after"), 1U);
  EXPECT_THAT(command.out(), HasSubstr("Link       1 reconnected, "));
  const json results = json::parse(contents(folder_.path("results.json")), nullptr, false);
  EXPECT_EQ(results.at("reconnects"), 1);
  EXPECT_GT(results.at("without_link_s"), 0.0);
  EXPECT_NEAR(results.at("ticks").get<double>(), 134.0, 2.0) << "2 s of both links together";
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

// A closed pseudo-terminal reports that at once and for ever: this must not make it spin.
TEST_F(DriveReconnectTest, WaitsWithoutTheProcessorAndComesBackEachTime) {
  constexpr std::size_t kTimes = 3;
  Command command{drive({"--duration", "60", "--reconnect"})};
  ASSERT_TRUE(starts_to_move());
  for (std::size_t times = 1; times <= kTimes; ++times) {
    server_->unplug();
    ASSERT_TRUE(waits(command, times)) << command.err();
    const double processor_before_s = processor_s(command.process());
    const double before_s = seconds(CLOCK_MONOTONIC);
    poll(nullptr, 0, 2000);  // the test is what it does meanwhile
    const double share = (processor_s(command.process()) - processor_before_s) /
                         (seconds(CLOCK_MONOTONIC) - before_s);
    EXPECT_GT(processor_before_s, 0.0);
    EXPECT_LT(share, 0.01);
    const double replugged_s = seconds(CLOCK_MONOTONIC);
    replug();
    ASSERT_TRUE(is_back(command, times)) << command.err();
    std::printf("waiting: %.2f %% of a CPU; back %.2f s after the port\n", 100.0 * share,
                seconds(CLOCK_MONOTONIC) - replugged_s);
    ASSERT_TRUE(starts_to_move());
  }
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

TEST_F(DriveReconnectTest, GivesUpInTheEnd) {
  Command command{drive({"--duration", "60", "--reconnect=0.5"})};
  ASSERT_TRUE(starts_to_move());
  server_->unplug();
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("robot is not there"));
  EXPECT_THAT(command.out(), HasSubstr("Wheel speed")) << "what was driven is told";
}

TEST_F(DriveReconnectTest, MayBeInterruptedWhileItWaits) {
  Command command{drive({"--duration", "60", "--reconnect=3600"})};
  ASSERT_TRUE(starts_to_move());
  server_->unplug();
  ASSERT_TRUE(waits(command));
  command.send(SIGTERM);
  EXPECT_EQ(command.exit_code(), 1) << "nobody told the robot to stop";
  EXPECT_THAT(command.err(), HasSubstr("interrupted while waiting"));
}

TEST_F(DriveReconnectTest, KeepsItsFeedAndLeavesTheTerminalsNameToOthers) {
  Command command{drive({"--duration", "60", "--reconnect"})};
  ASSERT_TRUE(starts_to_move());
  const std::string terminal = std::filesystem::canonical(port_);
  server_->unplug();
  ASSERT_TRUE(waits(command));
  const auto reader = hal::FeedReader::attach(port_);
  ASSERT_TRUE(reader) << reader.failure().message;
  EXPECT_THAT(reader->path(), Not(EndsWith(hal::feed_name(terminal))))
      << "the next pseudo-terminal has this name, and another robot";
  replug();
  ASSERT_TRUE(is_back(command));
  EXPECT_TRUE(hal::FeedReader::attach(std::filesystem::canonical(port_)));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
}

TEST_F(DriveReconnectTest, WantsANameThatLasts) {
  port_ = server_->path();
  if (std::filesystem::is_symlink(port_)) port_ = std::filesystem::canonical(port_);
  Command command{drive({"--reconnect"})};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("--link"));
}

TEST_F(DriveReconnectTest, RefusesATimeThatIsNone) {
  for (const char* seconds :
       {"--reconnect=-1", "--reconnect=0", "--reconnect=nan", "--reconnect=1e9", "--reconnect=2h"})
    EXPECT_EQ(Command(drive({seconds})).exit_code(), 1) << seconds;
}

}  // namespace
}  // namespace cargobay::test
