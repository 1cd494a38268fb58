#include "rt/slew_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr double kPeriod = 0.015;

TEST(SlewLimiter, ChangesNoFasterThanAllowed) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
  double former = 0.0;
  for (int tick = 0; tick < 100; ++tick) {
    const double target = tick % 20 < 10 ? 500.0 : -500.0;
    const double speed = limiter.step(target, kPeriod);
    EXPECT_LE(std::abs(speed - former), 15.0 + 1e-9);
    EXPECT_NEAR(limiter.rate_mm_s2(), (speed - former) / kPeriod, 1e-6);
    former = speed;
  }
}

TEST(SlewLimiter, ReachesTheTargetExactlyAndRests) {
  for (const double target : {200.0, -333.3, 0.1, 499.9}) {
    SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
    for (int tick = 0; tick < 40; ++tick) limiter.step(target, kPeriod);
    EXPECT_EQ(limiter.speed_mm_s(), target);
    EXPECT_EQ(limiter.rate_mm_s2(), 0.0);
  }
}

TEST(SlewLimiter, StopsAtExactlyZero) {
  for (const double from : {200.0, -333.3, 7.0 / 3.0}) {
    SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
    limiter.reset(from);
    for (int tick = 0; tick < 40; ++tick) limiter.step(0.0, kPeriod);
    EXPECT_EQ(limiter.speed_mm_s(), 0.0);
  }
}

TEST(SlewLimiter, TakesTheTimeThatTheAccelerationAsksFor) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
  int ticks = 0;
  while (limiter.step(300.0, kPeriod) < 300.0) ++ticks;
  EXPECT_EQ(ticks + 1, 20);  // 300 mm/s at 1000 mm/s^2: 0.3 s
}

TEST(SlewLimiter, StartsFromWhereItWasSet) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
  limiter.reset(100.0);
  EXPECT_EQ(limiter.step(500.0, kPeriod), 115.0);
}

// What holds for any request: checked over random limits, targets and times of change.
class JerkLimited : public testing::TestWithParam<unsigned> {
 protected:
  static constexpr double kRounding = 1e-6;

  double draw(double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random_);
  }
  // Towards the target; `former` is where the step began.
  static double gone(double former, double now, double target) {
    return target > former ? now - former : former - now;
  }

  std::mt19937 random_{GetParam()};
  SlewLimiter::Limits limits_{.acceleration_mm_s2 = draw(50.0, 5000.0),
                              .jerk_mm_s3 = std::exp(draw(std::log(100.0), std::log(1e6)))};
  SlewLimiter limiter_{limits_};
};

TEST_P(JerkLimited, NeverPassesTheTargetNorTurnsAway) {
  for (int move = 0; move < 200; ++move) {
    const double target = move % 5 == 0 ? 0.0 : draw(-500.0, 500.0);
    const auto steps = static_cast<int>(draw(1.0, 120.0));
    for (int step = 0; step < steps; ++step) {
      const double former = limiter_.speed_mm_s();
      const double speed = limiter_.step(target, kPeriod);
      EXPECT_GE(gone(former, speed, target), 0.0);
      EXPECT_LE(gone(former, speed, target), std::abs(target - former));
    }
  }
}

TEST_P(JerkLimited, KeepsBothLimits) {
  double rate = 0.0;
  for (int move = 0; move < 200; ++move) {
    const double target = draw(-500.0, 500.0);
    const auto steps = static_cast<int>(draw(1.0, 120.0));
    for (int step = 0; step < steps; ++step) {
      limiter_.step(target, kPeriod);
      const double now = limiter_.rate_mm_s2();
      EXPECT_LE(std::abs(now), limits_.acceleration_mm_s2 + kRounding);
      // Its growth, always. Its decrease, as long as the target has not moved.
      const double growth = limits_.jerk_mm_s3 * kPeriod + kRounding;
      EXPECT_LE(std::abs(now) - std::max(0.0, now > 0.0 ? rate : -rate), growth);
      if (step > 0) {
        EXPECT_LE(std::abs(now - rate), growth);
      }
      rate = now;
    }
  }
}

TEST_P(JerkLimited, ReachesTheTargetExactlyAndRests) {
  for (int move = 0; move < 50; ++move) {
    const double target = draw(-500.0, 500.0);
    const double way = std::abs(target - limiter_.speed_mm_s());
    // Up to full acceleration and down again, or as far as the way allows; then the rest.
    const double longest_s = way / limits_.acceleration_mm_s2 +
                             limits_.acceleration_mm_s2 / limits_.jerk_mm_s3 +
                             2.0 * std::sqrt(way / limits_.jerk_mm_s3);
    for (int step = 0; step < longest_s / kPeriod + 4.0; ++step) limiter_.step(target, kPeriod);
    EXPECT_EQ(limiter_.speed_mm_s(), target) << "move " << move;
    limiter_.step(target, kPeriod);
    EXPECT_EQ(limiter_.rate_mm_s2(), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, JerkLimited, testing::Range(1U, 41U));

TEST(SlewLimiter, AsIfThereWereNoJerkLimitWhereItIsFarAway) {
  SlewLimiter with{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 1e9}};
  SlewLimiter without{{.acceleration_mm_s2 = 1000.0}};
  for (int tick = 0; tick < 100; ++tick) {
    const double target = tick < 50 ? 432.1 : -17.0;
    EXPECT_NEAR(with.step(target, kPeriod), without.step(target, kPeriod), 1e-9);
  }
}

// Told to stop in the middle of an acceleration, it does not speed up first.
TEST(SlewLimiter, DropsAnAccelerationThatLeadsAway) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 5000.0}};
  for (int tick = 0; tick < 20; ++tick) limiter.step(500.0, kPeriod);
  const double before = limiter.speed_mm_s();
  ASSERT_GT(limiter.rate_mm_s2(), 900.0);
  EXPECT_LT(limiter.step(0.0, kPeriod), before);
  EXPECT_NEAR(limiter.rate_mm_s2(), -5000.0 * kPeriod, 1e-6);
}

// 200 mm/s at 1000 mm/s^2, 5000 mm/s^3: 0.2 s up to full acceleration, 0.2 s down from it.
TEST(SlewLimiter, TakesTheTimeThatTheJerkAsksFor) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 5000.0}};
  double time_s = kPeriod;
  while (limiter.step(200.0, kPeriod) < 200.0) time_s += kPeriod;
  EXPECT_NEAR(time_s, 0.4, kPeriod);
}

TEST(SlewLimiter, ResetsPastItsLimits) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 5000.0}};
  for (int tick = 0; tick < 20; ++tick) limiter.step(500.0, kPeriod);
  limiter.reset(0.0);
  EXPECT_EQ(limiter.step(0.0, kPeriod), 0.0);
  EXPECT_EQ(limiter.rate_mm_s2(), 0.0);
}

// However gentle the limits: 500 mm/s are gone after half a second.
TEST(SlewLimiter, BrakesAWheelThatNobodySteers) {
  for (const double from : {500.0, -500.0}) {
    SlewLimiter limiter{{.acceleration_mm_s2 = 20.0, .jerk_mm_s3 = 5.0}};
    limiter.reset(from);
    for (int tick = 0; tick < 33; ++tick) {
      EXPECT_NE(limiter.speed_mm_s(), 0.0);
      const double former = limiter.speed_mm_s();
      EXPECT_NEAR(std::abs(limiter.brake(kPeriod) - former), 15.0, 1e-9);
    }
    EXPECT_EQ(limiter.brake(kPeriod), 0.0);
    EXPECT_EQ(limiter.brake(kPeriod), 0.0);
  }
  SlewLimiter quick{{.acceleration_mm_s2 = 2000.0}};
  quick.reset(500.0);
  for (int tick = 0; tick < 17; ++tick) quick.brake(kPeriod);
  EXPECT_EQ(quick.speed_mm_s(), 0.0) << "no gentler than its limit";
}

}  // namespace
}  // namespace cargobay::rt
