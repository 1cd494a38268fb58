#include "rt/both_odometries.hpp"

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr auto kUnknown = RemainderBelief::unknown;
constexpr auto kCarried = RemainderBelief::carried;
constexpr auto kLost = RemainderBelief::lost;
constexpr bool kSure = true;

// A tick in which the robot went 3 mm if it carries the remainder and 3.5 mm if it loses it.
const Travels kOneTick{.if_carried = {.distance_mm = 3.0}, .if_lost = {.distance_mm = 3.5}};

class BothOdometriesAfter100Ticks : public testing::Test {
 protected:
  void SetUp() override { run(100, kUnknown, !kSure); }
  void run(int ticks, RemainderBelief belief, bool sure) {
    for (int i = 0; i < ticks; ++i) both_.step(kOneTick, belief, sure);
  }
  double x_mm() const { return both_.now().pose().x_mm; }
  BothOdometries both_{Odometry::Parameters{}};
};

TEST_F(BothOdometriesAfter100Ticks, TakesTheWayOfTheKindThatItTurnsOutToBe) {
  run(1, kCarried, !kSure);
  EXPECT_NEAR(x_mm(), 101 * 3.0, 1e-9);
  run(1, kLost, !kSure);
  EXPECT_NEAR(x_mm(), 102 * 3.5, 1e-9) << "and changes its mind while it is not sure";
  run(1, kCarried, kSure);
  EXPECT_NEAR(x_mm(), 103 * 3.0, 1e-9);
  EXPECT_NEAR(both_.now().distance_mm(), 103 * 3.0, 1e-9);
}

TEST_F(BothOdometriesAfter100Ticks, TakesTheCovarianceAlong) {
  const Travels unsure{.if_carried = {.distance_mm = 3.0},
                       .if_lost = {.distance_mm = 3.5, .distance_variance = 2.0}};
  for (int i = 0; i < 100; ++i) both_.step(unsure, kUnknown, !kSure);
  both_.step(kOneTick, kCarried, !kSure);
  const double carried = both_.now().covariance().xx;
  both_.step(kOneTick, kLost, kSure);
  EXPECT_GT(both_.now().covariance().xx, carried + 199.0);
}

// What was travelled while the kind was known is not undone by a later change of mind.
TEST_F(BothOdometriesAfter100Ticks, GoesOnFromWhereItWasLastSure) {
  run(100, kCarried, kSure);
  run(10, kCarried, !kSure);
  EXPECT_NEAR(x_mm(), 210 * 3.0, 1e-9);
  run(10, kLost, !kSure);
  EXPECT_NEAR(x_mm(), 200 * 3.0 + 20 * 3.5, 1e-9);
  run(10, kLost, kSure);
  run(1, kCarried, !kSure);
  EXPECT_NEAR(x_mm(), 200 * 3.0 + 30 * 3.5 + 3.0, 1e-9);
}

TEST_F(BothOdometriesAfter100Ticks, ResetsBoth) {
  both_.reset({.x_mm = 50.0, .y_mm = 7.0});
  EXPECT_EQ(x_mm(), 50.0);
  EXPECT_EQ(both_.now().covariance().xx, 0.0);
  run(10, kCarried, !kSure);
  EXPECT_NEAR(x_mm(), 80.0, 1e-9);
  run(1, kLost, !kSure);
  EXPECT_NEAR(x_mm(), 50.0 + 11 * 3.5, 1e-9);
  EXPECT_EQ(both_.now().pose().y_mm, 7.0);
}

TEST_F(BothOdometriesAfter100Ticks, ResetsWhileItIsSure) {
  run(50, kLost, kSure);
  both_.reset({});
  run(10, kLost, kSure);
  EXPECT_NEAR(x_mm(), 35.0, 1e-9);
  run(10, kLost, !kSure);
  run(10, kCarried, !kSure);
  EXPECT_NEAR(x_mm(), 35.0 + 20 * 3.0, 1e-9);
}

}  // namespace
}  // namespace cargobay::rt
