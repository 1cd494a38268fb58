// OI p. 6: what makes Safe mode stop and become Passive, but not Full.
#include "hal/sim/safety.hpp"

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers
using oi::Mode;

constexpr std::uint8_t kSafe = 131;
constexpr std::uint8_t kFull = 132;

struct Driving : Robot {
  Driving(std::uint8_t mode, WheelSpeeds mm_s) {
    const auto left = static_cast<std::uint16_t>(static_cast<std::int16_t>(mm_s.left_mm_s));
    const auto right = static_cast<std::uint16_t>(static_cast<std::int16_t>(mm_s.right_mm_s));
    send({128, mode, 145, static_cast<std::uint8_t>(right >> 8U), static_cast<std::uint8_t>(right),
          static_cast<std::uint8_t>(left >> 8U), static_cast<std::uint8_t>(left)});
    to_tick();
  }
};

TEST(Safety, StopsForEachCliffSensorWhenDrivingForward) {
  const auto trips = [](CliffSensor Inputs::* sensor) {
    Driving robot{kSafe, {200.0, 200.0}};
    (robot.device.inputs().*sensor).cliff = true;
    robot.to_tick();
    EXPECT_EQ(robot.device.last_safety_condition(), SafetyCondition::cliff);
    EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
    return robot.device.mode() == Mode::passive;
  };
  EXPECT_TRUE(trips(&Inputs::cliff_left));
  EXPECT_TRUE(trips(&Inputs::cliff_front_left));
  EXPECT_TRUE(trips(&Inputs::cliff_front_right));
  EXPECT_TRUE(trips(&Inputs::cliff_right));
}

Mode mode_at_a_cliff(std::uint8_t mode, WheelSpeeds mm_s) {
  Driving robot{mode, mm_s};
  robot.device.inputs().cliff_front_left.cliff = true;
  robot.to_tick();
  return robot.device.mode();
}

TEST(Safety, HeedsCliffsByTheWayItGoes) {
  EXPECT_EQ(mode_at_a_cliff(kSafe, {0.0, 0.0}), Mode::safe) << "it stands";
  EXPECT_EQ(mode_at_a_cliff(kSafe, {-200.0, -200.0}), Mode::safe) << "straight back";
  EXPECT_EQ(mode_at_a_cliff(kSafe, {-200.0, -20.0}), Mode::passive)
      << "back, within its own circle";
  EXPECT_EQ(mode_at_a_cliff(kSafe, {-200.0, -150.0}), Mode::safe) << "back, on a wide arc";
  EXPECT_EQ(mode_at_a_cliff(kSafe, {-100.0, 100.0}), Mode::passive) << "in place";
}

TEST(Safety, IsNotForFullMode) {
  Driving robot{kFull, {200.0, 200.0}};
  robot.device.inputs().cliff_left.cliff = true;
  robot.device.inputs().wheel_drop_left = true;
  robot.device.inputs().charger = true;
  robot.wait(1s);
  EXPECT_EQ(robot.device.mode(), Mode::full);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 200.0);
  EXPECT_EQ(robot.device.counters().safety_stops, 0U);
}

TEST(Safety, StopsForAnyWheelDropEvenStanding) {
  for (bool Inputs::* drop :
       {&Inputs::wheel_drop_left, &Inputs::wheel_drop_right, &Inputs::wheel_drop_caster}) {
    Robot robot;
    robot.send({128, kSafe});
    robot.device.inputs().*drop = true;
    robot.to_tick();
    EXPECT_EQ(robot.device.mode(), Mode::passive);
    EXPECT_EQ(robot.device.last_safety_condition(), SafetyCondition::wheel_drop);
  }
}

TEST(Safety, StopsForTheChargerAndNotForTheHomeBase) {
  Driving robot{kSafe, {100.0, 100.0}};
  robot.device.inputs().home_base = true;
  robot.to_tick();
  EXPECT_EQ(robot.device.mode(), Mode::safe);
  robot.device.inputs().charger = true;
  robot.to_tick();
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.device.last_safety_condition(), SafetyCondition::charger);
}

TEST(Safety, StopsAllMotors) {
  Robot robot;
  robot.send({128, kSafe, 138, 7});
  robot.device.inputs().wheel_drop_left = true;
  robot.to_tick();
  EXPECT_EQ(robot.device.actuators().low_side_drivers, (std::array<std::uint8_t, 3>{}));
}

TEST(Safety, DoesNotLetSafeBeginWhereItCannotLast) {
  Robot robot;
  robot.device.inputs().wheel_drop_right = true;
  robot.to_tick();
  robot.send({128, kSafe});
  EXPECT_EQ(robot.device.mode(), Mode::safe);
  robot.to_tick();
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Safety, StaysPassiveWhenTheHazardIsOver) {
  Driving robot{kSafe, {200.0, 200.0}};
  robot.device.inputs().cliff_left.cliff = true;
  robot.to_tick();
  robot.device.inputs().cliff_left.cliff = false;
  robot.wait(1s);
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  robot.send({kSafe});
  EXPECT_EQ(robot.device.mode(), Mode::safe);
}

TEST(Safety, StopsARobotThatWaits) {
  Robot robot;
  robot.send({128, kSafe, 145, 0, 200, 0, 200, 156, 0x7f, 0xff});
  robot.wait(500ms);
  ASSERT_TRUE(robot.device.waiting());
  robot.device.inputs().cliff_front_right.cliff = true;
  robot.to_tick();
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
}

// The robot knows the direction it is told to go, not the one it goes (docs/protocol.md).
TEST(Safety, HeedsCliffsByTheCommandNotByTheMotion) {
  Driving coasting{kSafe, {200.0, 200.0}};
  coasting.wait(1s);
  coasting.send({145, 0, 0, 0, 0});
  EXPECT_GT(coasting.device.truth().speeds.left_mm_s, 50.0);
  coasting.device.inputs().cliff_left.cliff = true;
  coasting.to_tick();
  EXPECT_EQ(coasting.device.mode(), Mode::safe) << "it was told to stop";
  EXPECT_EQ(mode_at_a_cliff(kSafe, {5.0, 5.0}), Mode::passive) << "told to move, if too slowly";
}

TEST(Safety, GivesUpSafeWhereTheChargerIsPluggedIn) {
  Robot robot;
  robot.send({128});
  robot.device.inputs().charger = true;
  robot.wait(100ms);
  robot.send({kSafe});
  EXPECT_EQ(robot.device.mode(), Mode::safe);
  robot.to_tick();
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.device.last_safety_condition(), SafetyCondition::charger);
  robot.to_tick();
  EXPECT_TRUE(robot.device.battery().charging()) << "again";
}

TEST(Safety, LeavesSafeOnTheHomeBaseAndDoesNotCharge) {
  Robot robot;
  robot.send({128});
  robot.device.inputs().home_base = true;
  robot.wait(100ms);
  EXPECT_TRUE(robot.device.battery().charging());
  robot.send({kSafe});
  robot.wait(1s);
  EXPECT_EQ(robot.device.mode(), Mode::safe);
  EXPECT_FALSE(robot.device.battery().charging());
  robot.send({128});
  robot.wait(100ms);
  EXPECT_TRUE(robot.device.battery().charging());
}

}  // namespace
}  // namespace cargobay::hal::sim
