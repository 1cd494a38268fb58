// `cargobay sensors`, frame by frame.
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
#include "tests/pty/serial_client.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using testing::HasSubstr;

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

}  // namespace
}  // namespace cargobay::test
