#include "rt/slew_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr double kPeriod = 0.015;

// Both wheels alike.
double step(SlewLimiter& limiter, double target_mm_s) {
  const WheelSpeeds speeds = limiter.step({target_mm_s, target_mm_s}, kPeriod);
  EXPECT_EQ(speeds.left_mm_s, speeds.right_mm_s);
  return speeds.left_mm_s;
}
double speed(const SlewLimiter& limiter) { return limiter.speeds().left_mm_s; }
double rate(const SlewLimiter& limiter) { return limiter.rates().left_mm_s; }

TEST(SlewLimiter, ChangesNoFasterThanAllowed) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
  double former = 0.0;
  for (int tick = 0; tick < 100; ++tick) {
    const double target = tick % 20 < 10 ? 500.0 : -500.0;
    const double now = step(limiter, target);
    EXPECT_LE(std::abs(now - former), 15.0 + 1e-9);
    EXPECT_NEAR(rate(limiter), (now - former) / kPeriod, 1e-6);
    former = now;
  }
}

TEST(SlewLimiter, ReachesTheTargetExactlyAndRests) {
  for (const double target : {200.0, -333.3, 0.1, 499.9}) {
    SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
    for (int tick = 0; tick < 40; ++tick) step(limiter, target);
    EXPECT_EQ(speed(limiter), target);
    EXPECT_EQ(rate(limiter), 0.0);
  }
}

TEST(SlewLimiter, StopsAtExactlyZero) {
  for (const double from : {200.0, -333.3, 7.0 / 3.0}) {
    SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
    limiter.reset({from, from});
    for (int tick = 0; tick < 40; ++tick) step(limiter, 0.0);
    EXPECT_EQ(speed(limiter), 0.0);
  }
}

TEST(SlewLimiter, TakesTheTimeThatTheAccelerationAsksFor) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
  int ticks = 0;
  while (step(limiter, 300.0) < 300.0) ++ticks;
  EXPECT_EQ(ticks + 1, 20);  // 300 mm/s at 1000 mm/s^2: 0.3 s
}

TEST(SlewLimiter, StartsFromWhereItWasSet) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
  limiter.reset({100.0, 100.0});
  EXPECT_EQ(step(limiter, 500.0), 115.0);
}

// What holds for any request: checked over random limits, targets and times of change.
class JerkLimited : public testing::TestWithParam<unsigned> {
 protected:
  static constexpr double kRounding = 1e-6;

  double draw(double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random_);
  }
  WheelSpeeds draw_target() { return {draw(-500.0, 500.0), draw(-500.0, 500.0)}; }
  double WheelSpeeds::* leading(const WheelSpeeds& target) const {
    const double left = std::abs(target.left_mm_s - limiter_.speeds().left_mm_s);
    const double right = std::abs(target.right_mm_s - limiter_.speeds().right_mm_s);
    return left >= right ? &WheelSpeeds::left_mm_s : &WheelSpeeds::right_mm_s;
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
    const WheelSpeeds target = move % 5 == 0 ? WheelSpeeds{} : draw_target();
    const auto steps = static_cast<int>(draw(1.0, 120.0));
    for (int step = 0; step < steps; ++step) {
      const WheelSpeeds former = limiter_.speeds();
      const WheelSpeeds now = limiter_.step(target, kPeriod);
      for (double WheelSpeeds::* wheel : {&WheelSpeeds::left_mm_s, &WheelSpeeds::right_mm_s}) {
        const double way = std::abs(target.*wheel - former.*wheel);
        EXPECT_GE(gone(former.*wheel, now.*wheel, target.*wheel), 0.0);
        EXPECT_LE(gone(former.*wheel, now.*wheel, target.*wheel), way + kRounding);
      }
    }
  }
}

// Of the wheel that changes more. The other changes less, so it keeps the acceleration too.
TEST_P(JerkLimited, KeepsBothLimits) {
  for (int move = 0; move < 200; ++move) {
    const WheelSpeeds target = draw_target();
    const auto leader = leading(target);
    const auto steps = static_cast<int>(draw(1.0, 120.0));
    for (int step = 0; step < steps; ++step) {
      const double rate = limiter_.rates().*leader;
      limiter_.step(target, kPeriod);
      const double now = limiter_.rates().*leader;
      EXPECT_LE(std::abs(limiter_.rates().left_mm_s), limits_.acceleration_mm_s2 + kRounding);
      EXPECT_LE(std::abs(limiter_.rates().right_mm_s), limits_.acceleration_mm_s2 + kRounding);
      // Its growth, always. Its decrease, as long as the target has not moved.
      const double growth = limits_.jerk_mm_s3 * kPeriod + kRounding;
      EXPECT_LE(std::abs(now) - std::max(0.0, now > 0.0 ? rate : -rate), growth);
      if (step > 0) {
        EXPECT_LE(std::abs(now - rate), growth);
      }
    }
  }
}

TEST_P(JerkLimited, ReachesTheTargetExactlyAndRests) {
  for (int move = 0; move < 50; ++move) {
    const WheelSpeeds target = draw_target();
    const auto leader = leading(target);
    const double way = std::abs(target.*leader - limiter_.speeds().*leader);
    // Up to full acceleration and down again, or as far as the way allows; then the rest.
    const double longest_s = way / limits_.acceleration_mm_s2 +
                             limits_.acceleration_mm_s2 / limits_.jerk_mm_s3 +
                             2.0 * std::sqrt(way / limits_.jerk_mm_s3);
    for (int step = 0; step < longest_s / kPeriod + 4.0; ++step) limiter_.step(target, kPeriod);
    EXPECT_EQ(limiter_.speeds(), target) << "move " << move;
    limiter_.step(target, kPeriod);
    EXPECT_EQ(limiter_.rates(), WheelSpeeds{});
  }
}

TEST_P(JerkLimited, KeepsToTheCurveFromStanding) {
  const WheelSpeeds target = draw_target();
  for (int step = 0; limiter_.speeds() != target && step < 100'000; ++step) {
    const WheelSpeeds now = limiter_.step(target, kPeriod);
    EXPECT_NEAR(now.left_mm_s * target.right_mm_s, now.right_mm_s * target.left_mm_s, kRounding);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, JerkLimited, testing::Range(1U, 41U));

TEST(SlewLimiter, AsIfThereWereNoJerkLimitWhereItIsFarAway) {
  SlewLimiter with{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 1e9}};
  SlewLimiter without{{.acceleration_mm_s2 = 1000.0}};
  for (int tick = 0; tick < 100; ++tick) {
    const double target = tick < 50 ? 432.1 : -17.0;
    EXPECT_NEAR(step(with, target), step(without, target), 1e-9);
  }
}

// Told to stop in the middle of an acceleration, it does not speed up first.
TEST(SlewLimiter, DropsAnAccelerationThatLeadsAway) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 5000.0}};
  for (int tick = 0; tick < 20; ++tick) step(limiter, 500.0);
  const double before = speed(limiter);
  ASSERT_GT(rate(limiter), 900.0);
  EXPECT_LT(step(limiter, 0.0), before);
  EXPECT_NEAR(rate(limiter), -5000.0 * kPeriod, 1e-6);
}

// 200 mm/s at 1000 mm/s^2, 5000 mm/s^3: 0.2 s up to full acceleration, 0.2 s down from it.
TEST(SlewLimiter, TakesTheTimeThatTheJerkAsksFor) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 5000.0}};
  double time_s = kPeriod;
  while (step(limiter, 200.0) < 200.0) time_s += kPeriod;
  EXPECT_NEAR(time_s, 0.4, kPeriod);
}

TEST(SlewLimiter, ResetsPastItsLimits) {
  SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0, .jerk_mm_s3 = 5000.0}};
  for (int tick = 0; tick < 20; ++tick) step(limiter, 500.0);
  limiter.reset({});
  EXPECT_EQ(step(limiter, 0.0), 0.0);
  EXPECT_EQ(rate(limiter), 0.0);
}

// The wheel with the longer way takes all of the limit, and both arrive in the same step.
TEST(SlewLimiter, LetsBothWheelsArriveTogether) {
  for (const WheelSpeeds& target :
       {WheelSpeeds{300, 100}, WheelSpeeds{-60, 240}, WheelSpeeds{0, -400}}) {
    SlewLimiter limiter{{.acceleration_mm_s2 = 1000.0}};
    limiter.reset({100.0, 50.0});
    const double left_way = target.left_mm_s - 100.0;
    const double right_way = target.right_mm_s - 50.0;
    const double most = std::max(std::abs(left_way), std::abs(right_way));
    const int ticks = static_cast<int>(std::ceil(most / 15.0));
    for (int tick = 1; tick < ticks; ++tick) {
      const WheelSpeeds now = limiter.step(target, kPeriod);
      EXPECT_NEAR(now.left_mm_s, 100.0 + left_way * 15.0 * tick / most, 1e-9);
      EXPECT_NEAR(now.right_mm_s, 50.0 + right_way * 15.0 * tick / most, 1e-9);
      EXPECT_NEAR(limiter.rates().left_mm_s, 1000.0 * left_way / most, 1e-6);
      EXPECT_NEAR(limiter.rates().right_mm_s, 1000.0 * right_way / most, 1e-6);
    }
    EXPECT_EQ(limiter.step(target, kPeriod), target);
  }
}

// Nothing but a look: the next step is as it would have been.
TEST(SlewLimiter, LooksAhead) {
  for (const double jerk_mm_s3 : {0.0, 5000.0}) {
    SlewLimiter slew{{.acceleration_mm_s2 = 500.0, .jerk_mm_s3 = jerk_mm_s3}};
    const WheelSpeeds target{300.0, -150.0};
    for (int i = 0; i < 100; ++i) {
      const SlewLimiter now = slew;
      const SlewLimiter later = now.ahead(target, 3 * 0.015, 0.015);
      EXPECT_EQ(now.ahead(target, 0.0, 0.015).speeds(), now.speeds());
      SlewLimiter steps = now;
      for (int step = 0; step < 3; ++step) steps.step(target, 0.015);
      EXPECT_NEAR(later.speeds().left_mm_s, steps.speeds().left_mm_s, 1e-9) << i;
      EXPECT_NEAR(later.rates().right_mm_s, steps.rates().right_mm_s, 1e-9) << i;
      if (jerk_mm_s3 == 0.0 && i > 0 && i < 30) {
        const SlewLimiter half = now.ahead(target, 0.0075, 0.015);
        EXPECT_NEAR(half.speeds().left_mm_s, now.speeds().left_mm_s + 3.75, 1e-9) << i;
      }
      slew.step(target, 0.015);
    }
  }
}

}  // namespace
}  // namespace cargobay::rt
