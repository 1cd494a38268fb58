// OI p. 9: Drive and Drive Direct.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Driven : Robot {
  explicit Driven(const Parameters& parameters = ideal_wheels()) : Robot{parameters} {
    send({128, 132});
  }
  WheelSpeeds command(const Bytes& bytes) {
    send(bytes);
    return device.commanded();
  }
};

TEST(Drive, DrivesTheManualsExample) {
  Driven robot;
  const WheelSpeeds speeds = robot.command({137, 255, 56, 1, 244});  // -200 mm/s, radius 500 mm
  EXPECT_DOUBLE_EQ(speeds.left_mm_s, -200.0 * (1.0 - 129.0 / 500.0));
  EXPECT_DOUBLE_EQ(speeds.right_mm_s, -200.0 * (1.0 + 129.0 / 500.0));
}

TEST(Drive, GoesStraightBothWaysOfSayingSo) {
  for (const Bytes& radius : {Bytes{0x80, 0x00}, Bytes{0x7f, 0xff}}) {
    Driven robot;
    const WheelSpeeds speeds = robot.command({137, 1, 44, radius[0], radius[1]});
    EXPECT_EQ(speeds.left_mm_s, 300.0);
    EXPECT_EQ(speeds.right_mm_s, 300.0);
  }
}

TEST(Drive, TurnsInPlace) {
  Driven robot;
  WheelSpeeds speeds = robot.command({137, 0, 100, 0xff, 0xff});
  EXPECT_EQ(speeds.left_mm_s, 100.0) << "clockwise";
  EXPECT_EQ(speeds.right_mm_s, -100.0);
  speeds = robot.command({137, 0, 100, 0, 1});
  EXPECT_EQ(speeds.left_mm_s, -100.0) << "counter-clockwise";
  EXPECT_EQ(speeds.right_mm_s, 100.0);
}

TEST(Drive, SlowsAnArcThatIsTooFastForItsOuterWheel) {
  Driven robot;
  const WheelSpeeds speeds =
      robot.command({137, 1, 244, 0, 129});  // 500 mm/s around the left wheel
  EXPECT_DOUBLE_EQ(speeds.left_mm_s, 0.0);
  EXPECT_DOUBLE_EQ(speeds.right_mm_s, 500.0);
}

// Found by fuzzing: rounding exceeded it.
TEST(Drive, IsNeverFasterThanAWheelMayBe) {
  Robot robot;
  robot.send({128, 132});
  for (int radius = -2000; radius <= 2000; ++radius) {
    for (const int velocity : {-500, -499, 333, 500}) {
      robot.send({137, static_cast<std::uint8_t>(velocity >> 8),
                  static_cast<std::uint8_t>(velocity), static_cast<std::uint8_t>(radius >> 8),
                  static_cast<std::uint8_t>(radius)});
      const WheelSpeeds speeds = robot.device.commanded();
      ASSERT_LE(std::abs(speeds.left_mm_s), 500.0) << velocity << " " << radius;
      ASSERT_LE(std::abs(speeds.right_mm_s), 500.0) << velocity << " " << radius;
    }
  }
}

TEST(Drive, BringsValuesIntoTheManualsRange) {
  Driven robot;
  const WheelSpeeds speeds = robot.command({137, 0x7f, 0xff, 0x80, 0x00});
  EXPECT_EQ(speeds.left_mm_s, 500.0);
  EXPECT_EQ(robot.ask({142, 39}), (Bytes{0x01, 0xf4}));
}

TEST(DriveDirect, HasTheRightWheelFirst) {
  Driven robot;
  const WheelSpeeds speeds = robot.command({145, 0, 150, 0xff, 56});
  EXPECT_EQ(speeds.right_mm_s, 150.0);
  EXPECT_EQ(speeds.left_mm_s, -200.0);
}

TEST(DriveDirect, MovesTheRobotAndItsOdometer) {
  Driven robot;
  robot.send({145, 0, 200, 0, 200});
  robot.wait(5s);
  EXPECT_NEAR(robot.device.truth().pose.x_mm, 1000.0, 1.0);
  robot.send({145, 0, 0, 0, 0});
  const Bytes reply = robot.ask({142, 2});
  ASSERT_EQ(reply.size(), 6U);
  EXPECT_NEAR(word(reply, 2), 1000, 4);
  EXPECT_EQ(word(reply, 4), 0);
}

TEST(DriveDirect, TurnsCounterClockwiseInPositiveDegrees) {
  Driven robot;
  robot.send({145, 0, 129, 0xff, 0x7f});  // a radian a second to the left
  robot.wait(1s);
  robot.send({145, 0, 0, 0, 0});
  EXPECT_NEAR(word(robot.ask({142, 20}), 0), 57, 2);
}

TEST(DriveDirect, IsRecordedWithTheTickItCameIn) {
  Driven robot;
  std::vector<DriveRecord> records;
  robot.device.on_drive = [&](const DriveRecord& record) { records.push_back(record); };
  robot.to_tick();
  robot.send({145, 0, 100, 0, 100});
  robot.send({145, 0, 100, 0, 101});
  robot.to_tick();
  robot.send({145, 0, 100, 0, 102});
  ASSERT_EQ(records.size(), 3U);
  EXPECT_EQ(records[0].tick, records[1].tick);
  EXPECT_EQ(records[2].tick, records[0].tick + 1);
  EXPECT_EQ(records[1].command.left_mm_s, 101.0);
  EXPECT_GT(records[1].time, records[0].time);
}

TEST(DriveDirect, LeavesTheSameTraceHoweverTimeIsCut) {
  const auto run = [](rt::Duration piece) {
    Robot robot;
    robot.send({128, 132, 145, 0, 100, 0, 200});
    const rt::Duration end = robot.device.now() + 3s;
    while (robot.device.now() < end) robot.wait(std::min(piece, end - robot.device.now()));
    robot.send({145, 0, 0, 0, 0});
    robot.wait(1s);
    return robot.device.truth().pose;
  };
  const WorldPose whole = run(3s);
  const WorldPose cut = run(1'234'567ns);
  EXPECT_EQ(whole.x_mm, cut.x_mm);
  EXPECT_EQ(whole.y_mm, cut.y_mm);
  EXPECT_EQ(whole.heading_rad, cut.heading_rad);
}

// Everything that a host sees and everything that is true, twice.
TEST(DriveDirect, RepeatsItselfUnderOneSeed) {
  const auto run = [](std::uint64_t seed) {
    Parameters parameters;
    parameters.seed = seed;
    Robot robot{parameters};
    robot.send({128, 132, 148, 2, 19, 20, 145, 0, 100, 0, 200});
    robot.wait(10s);
    return robot.receive();
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

}  // namespace
}  // namespace cargobay::hal::sim
