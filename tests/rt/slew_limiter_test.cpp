#include "rt/slew_limiter.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr double kTick = 0.015;

TEST(SlewLimiter, ChangesNoFasterThanAllowed) {
  SlewLimiter limiter{1000.0};
  double former = 0.0;
  for (int tick = 0; tick < 100; ++tick) {
    const double target = tick % 20 < 10 ? 500.0 : -500.0;
    const double speed = limiter.step(target, kTick);
    EXPECT_LE(std::abs(speed - former), 15.0 + 1e-9);
    EXPECT_NEAR(limiter.rate_mm_s2(), (speed - former) / kTick, 1e-6);
    former = speed;
  }
}

TEST(SlewLimiter, ReachesTheTargetExactlyAndRests) {
  for (const double target : {200.0, -333.3, 0.1, 499.9}) {
    SlewLimiter limiter{1000.0};
    for (int tick = 0; tick < 40; ++tick) limiter.step(target, kTick);
    EXPECT_EQ(limiter.speed_mm_s(), target);
    EXPECT_EQ(limiter.rate_mm_s2(), 0.0);
  }
}

TEST(SlewLimiter, StopsAtExactlyZero) {
  for (const double from : {200.0, -333.3, 7.0 / 3.0}) {
    SlewLimiter limiter{1000.0};
    limiter.reset(from);
    for (int tick = 0; tick < 40; ++tick) limiter.step(0.0, kTick);
    EXPECT_EQ(limiter.speed_mm_s(), 0.0);
  }
}

TEST(SlewLimiter, TakesTheTimeThatTheAccelerationAsksFor) {
  SlewLimiter limiter{1000.0};
  int ticks = 0;
  while (limiter.step(300.0, kTick) < 300.0) ++ticks;
  EXPECT_EQ(ticks + 1, 20);  // 300 mm/s at 1000 mm/s^2: 0.3 s
}

TEST(SlewLimiter, StartsFromWhereItWasSet) {
  SlewLimiter limiter{1000.0};
  limiter.reset(100.0);
  EXPECT_EQ(limiter.step(500.0, kTick), 115.0);
}

}  // namespace
}  // namespace cargobay::rt
