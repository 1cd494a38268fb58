// `cargobay sensors`: one reading, and frame by frame.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "drive_fixture.hpp"
#include "robot_tool.hpp"
#include "tests/pty/serial_client.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

std::vector<nlohmann::json> frames_of(const std::string& text) {
  std::vector<nlohmann::json> frames;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    auto frame = nlohmann::json::parse(line, nullptr, false);
    if (!frame.is_discarded()) frames.push_back(std::move(frame));
  }
  return frames;
}

TEST_F(DriveTest, SensorsAddsUpDistanceAndAngleAndTellsTheTime) {
  {
    const hal::sim::test::SerialClient client{port_};
    (void)client.ask({128, 131, 145, 0, 200, 0, 100}, 0);  // Start, Safe, Drive Direct
    ASSERT_TRUE(starts_to_move());
  }
  Command command{{"sensors", "--json", "--port", port_, "--packets", "distance,angle,distance"}};
  ASSERT_TRUE(eventually([&] {
    (void)command.running();
    return std::ranges::count(command.out(), '\n') > 50;
  }));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  const auto frames = frames_of(command.out());
  std::int64_t distance = 0;
  std::int64_t angle = 0;
  double time_s = -1.0;
  for (const auto& frame : frames) {
    distance += frame["distance"].get<std::int64_t>();
    angle += frame["angle"].get<std::int64_t>();
    EXPECT_EQ(frame["distance_sum"], distance);
    EXPECT_EQ(frame["angle_sum"], angle);
    EXPECT_GT(frame["time_s"], time_s);
    time_s = frame["time_s"];
    EXPECT_GT(frame["unix_time_s"], 1.7e9);
  }
  EXPECT_GT(distance, 50);
  EXPECT_GT(angle, 5);
}

TEST(Sensors, AreAskedForWhenTheLineIsTooSlowForAStream) {
  Command command{{"sensors", "--json", "--baud", "4800", "--config", "/dev/null"}};
  ASSERT_TRUE(eventually([&] {
    (void)command.running();
    return std::ranges::count(command.out(), '\n') >= 5;
  }));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_THAT(command.err(), HasSubstr("do not fit 4800 baud"));
}

class SensorsTool : public RobotTool {};

TEST_F(SensorsTool, PrintsOneReadingWhereThereIsNoTerminal) {
  const Outcome outcome = sensors({"--packets", "oi_mode,voltage"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, StartsWith(" 35  OI Mode                                 1 (passive)\n"
                                      " 22  Voltage "));
  EXPECT_THAT(outcome.out, HasSubstr(" mV\n"));
}

TEST_F(SensorsTool, PrintsJson) {
  const Outcome outcome = sensors({"--packets", "35,7", "--json", "--once"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out,
              MatchesRegex("\\{\"unix_time_s\":[0-9]+\\.[0-9]+,\"time_s\":0\\.0+,"
                           "\"bumps_and_wheel_drops\":0,\"bumps_and_wheel_drops_names\":\\[\\],"
                           "\"oi_mode\":1,\"oi_mode_name\":\"passive\"\\}\n"));
}

TEST_F(SensorsTool, StreamsJsonUntilASignal) {
  ToolProcess process{with_port("sensors", {"--packets", "35", "--json"})};
  const auto frames = [&process] { return frames_of(process.printed_so_far()).size(); };
  ASSERT_TRUE(eventually([&] { return frames() >= 3; }));
  EXPECT_THAT(process.printed_so_far(),
              HasSubstr(",\"oi_mode\":1,\"oi_mode_name\":\"passive\"}\n"));
  process.send_signal(SIGINT);
  EXPECT_EQ(process.wait().code, 0);
}

// By its guard, which looks after it ten times as seldom as after a drive.
TEST_F(SensorsTool, LeavesNoStreamWhenItIsKilled) {
  ToolProcess process{with_port("sensors", {"--packets", "35", "--json"})};
  ASSERT_TRUE(eventually([&] { return !frames_of(process.printed_so_far()).empty(); }));
  process.send_signal(SIGKILL);
  EXPECT_EQ(process.wait().code, 128 + SIGKILL);
  EXPECT_TRUE(eventually([&] { return streams_no_longer(); }));
}

TEST_F(SensorsTool, RefusesWhatItCannotDo) {
  EXPECT_THAT(sensors({"--packets", "99"}).error, HasSubstr("'99' is not a packet"));
  EXPECT_EQ(sensors({"--packets", "99"}).code, 1);
  const Outcome silent = sensors({"--baud", "9600", "--once"});
  EXPECT_EQ(silent.code, 1);
  EXPECT_THAT(silent.error, HasSubstr("the robot does not answer at 9600 baud"));
  EXPECT_THAT(run_tool({"sensors", "--port", "/dev/null"}).error, HasSubstr("not a terminal"));
}

}  // namespace
}  // namespace cargobay::test
