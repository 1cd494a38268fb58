#include "hal/sim/drive_train/wheels.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

TEST(Wheels, ReachThePartOfTheCommandThatIsTheirGain) {
  Wheels wheels{without_noise()};
  wheels.set_command({200.0, 200.0});
  wheels.advance(3s);
  EXPECT_NEAR(wheels.speeds().left_mm_s, 188.0, 1e-6);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 180.0, 1e-6);
}

TEST(Wheels, LagBehindTheCommandByTheirTimeConstant) {
  Wheels wheels{without_noise()};
  wheels.set_command({100.0, 100.0});
  wheels.advance(100ms);
  EXPECT_NEAR(wheels.speeds().left_mm_s, 94.0 * (1.0 - std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(wheels.left().travel_mm(), 94.0 * (0.1 - 0.1 * (1.0 - std::exp(-1.0))), 1e-9);
}

TEST(Wheels, StandStillBelowTheDeadBand) {
  Wheels wheels{Parameters{}};
  wheels.set_command({9.9, 10.0});
  for (int i = 0; i < 100; ++i) {
    wheels.tick();
    wheels.advance(15ms);
  }
  EXPECT_EQ(wheels.left().travel_mm(), 0.0);
  EXPECT_GT(wheels.right().travel_mm(), 10.0);
}

TEST(Wheels, DoNotMindHowTimeIsCut) {
  Wheels whole{without_noise()};
  Wheels cut{without_noise()};
  for (const WheelSpeeds command : {WheelSpeeds{300.0, 200.0}, WheelSpeeds{-100.0, 250.0}}) {
    whole.set_command(command);
    cut.set_command(command);
    whole.advance(700ms);
    for (int i = 1; i <= 70; ++i) cut.advance(i % 2 == 0 ? 3ms : 17ms);
  }
  EXPECT_NEAR(whole.pose().x_mm, cut.pose().x_mm, 1e-6);
  EXPECT_NEAR(whole.pose().y_mm, cut.pose().y_mm, 1e-6);
  EXPECT_NEAR(whole.pose().heading_rad, cut.pose().heading_rad, 1e-12);
  EXPECT_NEAR(whole.speeds().left_mm_s, cut.speeds().left_mm_s, 1e-9);
  EXPECT_EQ(whole.left().counts(), cut.left().counts());
  EXPECT_EQ(whole.right().counts(), cut.right().counts());
}

TEST(Wheels, DriveACircleBackToItsBeginning) {
  Wheels wheels{ideal_wheels()};
  // Radius 500 mm to the left, 200 mm/s: once around takes 5 pi seconds.
  wheels.set_command({200.0 * (1.0 - 129.0 / 500.0), 200.0 * (1.0 + 129.0 / 500.0)});
  wheels.advance(rt::Duration{static_cast<std::int64_t>(2.5e9 * std::numbers::pi)});
  EXPECT_NEAR(wheels.pose().x_mm, 0.0, 1e-3);
  EXPECT_NEAR(wheels.pose().y_mm, 1000.0, 1e-3);
  EXPECT_NEAR(wheels.pose().heading_rad, std::numbers::pi, 1e-6);
  wheels.advance(rt::Duration{static_cast<std::int64_t>(2.5e9 * std::numbers::pi)});
  EXPECT_NEAR(wheels.pose().x_mm, 0.0, 1e-3);
  EXPECT_NEAR(wheels.pose().y_mm, 0.0, 1e-3);
}

TEST(Wheels, CountEveryEncoderEdge) {
  Wheels wheels{ideal_wheels()};
  wheels.set_command({100.0, -100.0});
  wheels.advance(10s);
  EXPECT_EQ(wheels.left().counts(), 7832);
  EXPECT_EQ(wheels.left().edges(), 7832);
  EXPECT_NEAR(static_cast<double>(wheels.right().counts()), -7832.0, 1.0);
  EXPECT_EQ(wheels.right().edges(), -wheels.right().counts());
}

TEST(Wheels, CountCoastingWithTheSignOfTheNewCommand) {
  Wheels wheels{without_noise()};
  wheels.set_command({300.0, 300.0});
  wheels.advance(1s);
  const std::int64_t before = wheels.left().counts();
  const double travel_before = wheels.left().travel_mm();
  wheels.set_command({-300.0, 0.0});
  wheels.advance(50ms);  // still rolling forward
  EXPECT_GT(wheels.left().travel_mm(), travel_before);
  EXPECT_LT(wheels.left().counts(), before);
  EXPECT_GT(wheels.right().counts(), before * 9 / 10) << "a command of 0 keeps the sign";
}

TEST(Wheels, CountBothWaysOverAnEdgeWhereTheDirectionChanges) {
  Wheels wheels{without_noise()};
  wheels.set_command({300.0, 300.0});
  wheels.advance(1s);
  const std::int64_t edges = wheels.left().edges();
  const double travel = wheels.left().travel_mm();
  wheels.set_command({-300.0, -300.0});
  wheels.advance(1s);
  // Forward to the reversal, and back over all of it.
  const double there = 282.0 * 0.1 * (1.0 - std::log(2.0));
  const double back = travel + there - wheels.left().travel_mm();
  EXPECT_NEAR(static_cast<double>(wheels.left().edges() - edges), (there + back) * 7.8324, 2.0);
}

TEST(Wheel, LosesNoEdgeWhereAStepHoldsTheReversal) {
  const auto edges = [](int pieces) {
    WheelParameters parameters;
    parameters.gain_left = 1.0;
    Wheel wheel{parameters, Side::left};
    wheel.set_command(300.0);
    wheel.advance(1.0);
    wheel.set_command(-300.0);
    for (int i = 0; i < pieces; ++i) wheel.advance(0.2 / pieces);
    return wheel.edges();
  };
  EXPECT_EQ(edges(1), edges(2000));
}

TEST(Wheels, RepeatTheirNoiseUnderOneSeedAndNotUnderAnother) {
  const auto travelled = [](std::uint64_t seed) {
    Parameters parameters;
    parameters.seed = seed;
    Wheels wheels{parameters};
    wheels.set_command({200.0, 200.0});
    for (int i = 0; i < 200; ++i) {
      wheels.tick();
      wheels.advance(15ms);
    }
    return wheels.left().travel_mm();
  };
  EXPECT_EQ(travelled(7), travelled(7));
  EXPECT_NE(travelled(7), travelled(8));
}

TEST(Wheels, WanderAroundTheirSpeedByAboutTheNoise) {
  Wheels wheels{Parameters{}};
  wheels.set_command({200.0, 200.0});
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kTicks = 20000;
  for (int i = 0; i < kTicks; ++i) {
    wheels.tick();
    wheels.advance(15ms);
    const double error_mm_s = wheels.speeds().left_mm_s - 188.0;
    if (i < 100) continue;
    sum += error_mm_s;
    squares += error_mm_s * error_mm_s;
  }
  EXPECT_NEAR(sum / kTicks, 0.0, 0.1);
  // 1 mm/s with a correlation time of 150 ms, through a lag of 100 ms.
  EXPECT_NEAR(std::sqrt(squares / kTicks), std::sqrt(0.6), 0.08);
}

TEST(Wheels, HoldStillWhileBlocked) {
  Wheels wheels{without_noise()};
  wheels.set_command({200.0, 200.0});
  wheels.advance(1s);
  const std::int64_t counts = wheels.left().counts();
  wheels.set_blocked(true, false);
  wheels.advance(1s);
  EXPECT_EQ(wheels.left().counts(), counts);
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 180.0, 0.1);
}

// OI p. 16: "if the wheels are passively rotated in either direction, the distance is incremented".
TEST(TurnedByHand, WheelsCountUpEitherWay) {
  for (const double mm_s : {-100.0, 100.0}) {
    Robot robot{ideal_wheels()};
    robot.send({128, 132, 145, 0xff, 0x9c, 0xff, 0x9c});  // the last way was back
    robot.wait(1s);
    robot.send({145, 0, 0, 0, 0});
    robot.wait(100ms);
    (void)robot.ask({142, 2});
    const double before_mm = robot.device.truth().pose.x_mm;
    robot.device.turn_wheels({.left_mm_s = mm_s, .right_mm_s = mm_s});
    robot.wait(2s);
    robot.device.turn_wheels({});
    robot.wait(100ms);
    EXPECT_NEAR(robot.device.truth().pose.x_mm - before_mm, 2.0 * mm_s, 1.0);
    EXPECT_NEAR(word(robot.ask({142, 19}), 0), 200, 2) << mm_s;
  }
}

TEST(TurnedByHand, WheelsEndAWaitForADistance) {
  Robot robot{ideal_wheels()};
  robot.send({128, 156, 0, 100});
  robot.wait(1s);
  EXPECT_TRUE(robot.device.waiting());
  robot.device.turn_wheels({.left_mm_s = -200.0, .right_mm_s = -200.0});
  robot.wait(600ms);
  EXPECT_FALSE(robot.device.waiting());
}

TEST(TurnedByHand, WheelsYieldToTheirMotors) {
  Robot robot{ideal_wheels()};
  robot.device.turn_wheels({.left_mm_s = 300.0, .right_mm_s = 300.0});
  robot.send({128, 132, 145, 0xff, 0x9c, 0xff, 0x9c});
  robot.wait(100ms);
  EXPECT_NEAR(robot.device.truth().speeds.left_mm_s, -100.0, 1e-6);
  robot.send({128});
  robot.wait(100ms);
  EXPECT_NEAR(robot.device.truth().speeds.left_mm_s, 300.0, 1e-6) << "the hand is still there";
}

TEST(TurnedByHand, WheelsTurnARobotThatIsOff) {
  Parameters parameters = ideal_wheels();
  parameters.power_on = PowerOn::never;
  Robot robot{parameters};
  robot.device.turn_wheels({.left_mm_s = 0.0, .right_mm_s = 100.0});
  robot.wait(1s);
  EXPECT_GT(robot.device.truth().pose.heading_rad, 0.3);
}

}  // namespace
}  // namespace cargobay::hal::sim
