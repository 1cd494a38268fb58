#include "rt/velocity_controller.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using Parameters = VelocityController::Parameters;

TEST(VelocityController, SendsTheSetSpeedWhereThereIsNoError) {
  VelocityController controller{Parameters{}};
  for (int tick = 0; tick < 100; ++tick) EXPECT_EQ(controller.step(200.0, 0.0, 200.0), 200.0);
}

TEST(VelocityController, LeadsByTheLagWhileTheSetSpeedChanges) {
  VelocityController controller{Parameters{.lag_s = 0.1}};
  EXPECT_EQ(controller.step(200.0, 1000.0, 200.0), 300.0);
}

// A wheel that falls 10 % short.
TEST(VelocityController, TakesTheDroopAway) {
  VelocityController controller{Parameters{}};
  double speed_mm_s = 0.0;
  double command_mm_s = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    command_mm_s = controller.step(200.0, 0.0, speed_mm_s);
    speed_mm_s += (0.9 * command_mm_s - speed_mm_s) * (1.0 - std::exp(-0.015 / 0.1));
  }
  EXPECT_NEAR(speed_mm_s, 200.0, 0.01);
  EXPECT_NEAR(command_mm_s, 200.0 / 0.9, 0.01);
}

TEST(VelocityController, StaysWithinTheLimit) {
  VelocityController controller{Parameters{}};
  EXPECT_EQ(controller.step(490.0, 1000.0, 0.0), 500.0);
  EXPECT_EQ(controller.step(-490.0, -1000.0, 0.0), -500.0);
}

// After a minute against the limit, in either direction.
TEST(VelocityController, LeavesTheLimitAtOnceWhenTheErrorChangesSign) {
  for (const double sign : {1.0, -1.0}) {
    VelocityController controller{Parameters{}};
    for (int tick = 0; tick < 4000; ++tick) {
      ASSERT_EQ(controller.step(sign * 480.0, 0.0, sign * 300.0), sign * 500.0);
    }
    const double command_mm_s = controller.step(sign * 480.0, 0.0, sign * 500.0);
    EXPECT_LT(sign * command_mm_s, 500.0);
    EXPECT_NEAR(controller.integral_mm_s(), 0.0, 60.0) << "no more than fits below the limit";
  }
}

// A set speed just within reach, with a droop that is not: the integral must not run away either.
TEST(VelocityController, DoesNotWindUpOverADroopThatItCannotTakeAway) {
  VelocityController controller{Parameters{}};
  double speed_mm_s = 0.0;
  const auto run = [&](double set_mm_s, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      const double command_mm_s = controller.step(set_mm_s, 0.0, speed_mm_s);
      speed_mm_s += (0.9 * command_mm_s - speed_mm_s) * (1.0 - std::exp(-0.015 / 0.1));
    }
  };
  run(480.0, 4000);
  EXPECT_NEAR(speed_mm_s, 450.0, 0.1);
  run(300.0, 67);  // 1 s
  EXPECT_NEAR(speed_mm_s, 300.0, 10.0);
}

TEST(VelocityController, StillUnwindsWhileItIsAtTheLimit) {
  VelocityController controller{Parameters{}};
  for (int tick = 0; tick < 100; ++tick) (void)controller.step(300.0, 0.0, 250.0);
  const double before_mm_s = controller.integral_mm_s();
  ASSERT_GT(before_mm_s, 100.0);
  // Already too fast, and still asked to go at the limit.
  EXPECT_EQ(controller.step(499.0, 0.0, 505.0), 500.0);
  EXPECT_LT(controller.integral_mm_s(), before_mm_s);
}

TEST(VelocityController, ForgetsOnReset) {
  VelocityController controller{Parameters{}};
  for (int tick = 0; tick < 100; ++tick) (void)controller.step(300.0, 0.0, 250.0);
  controller.reset();
  EXPECT_EQ(controller.step(200.0, 0.0, 200.0), 200.0);
}

}  // namespace
}  // namespace cargobay::rt
