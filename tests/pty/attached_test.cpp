// Commands beside a drive: they show what its feed tells, and leave its port alone.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using testing::HasSubstr;
using testing::Not;

class AttachedTest : public DriveTest {
 protected:
  void SetUp() override {
    DriveTest::SetUp();
    drive_ = std::make_unique<Command>(std::vector<std::string>{
        "drive", "--port", port_, "--duration", "600", "--config", "/dev/null"});
    ASSERT_TRUE(starts_to_move());
  }
  void TearDown() override {
    if (drive_->running()) {
      drive_->send(SIGINT);
      EXPECT_EQ(drive_->exit_code(), 128 + SIGINT) << drive_->err();
    }
    EXPECT_THAT(drive_->err(), Not(HasSubstr("also has it open")));
    DriveTest::TearDown();
  }
  std::unique_ptr<Command> drive_{};
};

TEST_F(AttachedTest, SensorsShowsTheFramesOfTheDrive) {
  Command command{{"sensors", "--json", "--port", port_, "--packets", "distance,oi_mode"}};
  ASSERT_TRUE(eventually([&] {
    (void)command.running();
    return std::ranges::count(command.out(), '\n') > 50;
  }));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.err(), HasSubstr("cargobay drive (process"));
  std::istringstream lines{command.out()};
  std::int64_t distance = 0;
  double time_s = -1.0;
  for (std::string line; std::getline(lines, line);) {
    const auto frame = nlohmann::json::parse(line, nullptr, false);
    ASSERT_FALSE(frame.is_discarded()) << line;
    distance += frame["distance"].get<std::int64_t>();
    EXPECT_EQ(frame["distance_sum"], distance);
    EXPECT_EQ(frame["oi_mode_name"], "safe");
    EXPECT_FALSE(frame.contains("voltage"));
    EXPECT_GT(frame["time_s"], time_s);
    time_s = frame["time_s"];
  }
  EXPECT_GT(distance, 20);
}

TEST_F(AttachedTest, SensorsOnceLeavesOutWhatTheDriveDoesNotRead) {
  Command command{{"sensors", "--once", "--port", port_, "--packets", "voltage,wall_signal"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), HasSubstr("Voltage"));
  EXPECT_THAT(command.out(), Not(HasSubstr("Wall Signal")));
}

TEST_F(AttachedTest, SensorsEndsWithTheDrive) {
  Command command{{"sensors", "--json", "--port", port_}};
  ASSERT_TRUE(eventually([&] {
    (void)command.running();
    return std::ranges::count(command.out(), '\n') > 5;
  }));
  drive_->send(SIGINT);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("has ended"));
}

}  // namespace
}  // namespace cargobay::test
