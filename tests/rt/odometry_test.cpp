#include "rt/odometry.hpp"

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "rt/wheel_estimator.hpp"
#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Odometry, GoesStraight) {
  Odometry odometry{{}};
  odometry.reset({.x_mm = 10.0, .y_mm = 20.0, .heading_rad = kPi / 2.0});
  for (int i = 0; i < 100; ++i) odometry.step({.distance_mm = 3.0});
  EXPECT_NEAR(odometry.pose().x_mm, 10.0, 1e-9);
  EXPECT_NEAR(odometry.pose().y_mm, 320.0, 1e-9);
  EXPECT_DOUBLE_EQ(odometry.distance_mm(), 300.0);
}

// An arc stays the same arc, in any number of steps.
TEST(Odometry, ClosesACircle) {
  Odometry odometry{{}};
  constexpr int kSteps = 400;
  constexpr double kRadius = 500.0;
  for (int i = 0; i < kSteps; ++i) {
    odometry.step({.distance_mm = 2.0 * kPi * kRadius / kSteps, .turn_rad = 2.0 * kPi / kSteps});
    if (i == kSteps / 2 - 1) {
      EXPECT_NEAR(odometry.pose().y_mm, 2.0 * kRadius, 1e-4);
    }
  }
  EXPECT_NEAR(odometry.pose().x_mm, 0.0, 1e-4);
  EXPECT_NEAR(odometry.pose().y_mm, 0.0, 1e-4);
  EXPECT_NEAR(odometry.pose().heading_rad, 2.0 * kPi, 1e-9) << "not wrapped";
}

TEST(Odometry, ScalesWhatTheRobotReports) {
  Odometry odometry{{.distance_scale = 1.1, .turn_scale = 0.5}};
  odometry.step({.distance_mm = 100.0});
  odometry.step({.turn_rad = 1.0});
  EXPECT_NEAR(odometry.pose().x_mm, 110.0, 1e-9);
  EXPECT_NEAR(odometry.pose().heading_rad, 0.5, 1e-9);
}

// The reading after a metre says that the robot has turned: it has done so all along.
TEST(Odometry, BendsTheWayForATurnThatAReadingFinds) {
  Odometry odometry{{}};
  odometry.reset({.x_mm = 100.0});
  odometry.step({.distance_mm = 500.0, .turn_rad = 0.02, .turn_corrected_rad = 0.02});
  const OdometryPose before = odometry.pose();
  for (int i = 0; i < 1000; ++i) odometry.step({.distance_mm = 1.0});
  odometry.step({.turn_rad = 0.04, .turn_corrected_rad = 0.04});
  EXPECT_NEAR(odometry.pose().heading_rad, 0.06, 1e-9);
  EXPECT_NEAR(odometry.pose().x_mm - before.x_mm, 1000.0, 1.5);
  EXPECT_NEAR(odometry.pose().y_mm - before.y_mm, 1000.0 * (0.02 + 0.04 / 2.0), 0.5);
}

// Slowly along the way, faster and faster across it: the heading error acts over the whole way.
TEST(Odometry, GrowsLessSure) {
  Odometry odometry{{.slip_mm2_per_mm = 0.001, .wheel_error = 0.0, .base_error = 0.0}};
  for (int i = 0; i < 1000; ++i) odometry.step({.distance_mm = 1.0});
  const auto at_1_m = odometry.covariance();
  EXPECT_NEAR(std::sqrt(at_1_m.xx), std::sqrt(0.001 * 1000.0 / 2.0), 0.01) << "two wheels' mean";
  for (int i = 0; i < 1000; ++i) odometry.step({.distance_mm = 1.0});
  const auto at_2_m = odometry.covariance();
  EXPECT_NEAR(at_2_m.xx / at_1_m.xx, 2.0, 0.01);
  EXPECT_NEAR(at_2_m.yy / at_1_m.yy, 8.0, 0.1) << "the cube of the way";
  odometry.reset({});
  EXPECT_EQ(odometry.covariance().xx, 0.0);
}

// Distance not read yet is uncertain, but the uncertainty does not accumulate.
TEST(Odometry, DoesNotAddUpWhatIsStillToBeRead) {
  Odometry odometry{{.slip_mm2_per_mm = 0.0, .wheel_error = 0.0, .base_error = 0.0}};
  for (int i = 0; i < 500; ++i)
    odometry.step({.distance_mm = 1.0, .unread_distance_variance = 0.3});
  EXPECT_NEAR(odometry.covariance().xx, 0.3, 1e-9);
  odometry.step({.distance_mm = 1.0});
  EXPECT_NEAR(odometry.covariance().xx, 0.0, 1e-9);
  for (int i = 0; i < 100; ++i) odometry.step({.distance_mm = 1.0, .distance_variance = 0.1});
  EXPECT_NEAR(odometry.covariance().xx, 10.0, 1e-6) << "what is lost is lost for good";
}

// A pose after a drive, and its covariance, by what the wheels are told to go, in steps.
OdometryPose driven(std::span<const WheelSpeeds> steps_mm, double left, double right, double base) {
  Odometry odometry{{}};
  constexpr double kBaseMm = 258.0;
  for (const WheelSpeeds& step : steps_mm) {
    const double left_mm = step.left_mm_s * (1.0 + left);
    const double right_mm = step.right_mm_s * (1.0 + right);
    odometry.step({.distance_mm = (left_mm + right_mm) / 2.0,
                   .turn_rad = (right_mm - left_mm) / (kBaseMm * (1.0 + base))});
  }
  return odometry.pose();
}

// What lasts grows with the way, not with its root: the covariance is what small errors of the
// wheels and the base do to the pose, by differences.
TEST(Odometry, KnowsWhatALastingErrorDoesToThePose) {
  std::vector<WheelSpeeds> steps;
  steps.reserve(400);
  for (int i = 0; i < 400; ++i) steps.push_back(i < 250 ? WheelSpeeds{2, 3} : WheelSpeeds{-1, 2});
  constexpr double kError = 1e-4;
  Odometry odometry{{.slip_mm2_per_mm = 0.0, .wheel_error = kError, .base_error = kError}};
  for (const WheelSpeeds& step : steps) {
    odometry.step({.distance_mm = (step.left_mm_s + step.right_mm_s) / 2.0,
                   .turn_rad = (step.right_mm_s - step.left_mm_s) / 258.0});
  }
  const OdometryPose right = driven(steps, 0.0, 0.0, 0.0);
  PoseCovariance wanted;
  for (const OdometryPose& wrong :
       {driven(steps, kError, 0.0, 0.0), driven(steps, 0.0, kError, 0.0),
        driven(steps, 0.0, 0.0, kError)}) {
    const double x = wrong.x_mm - right.x_mm;
    const double y = wrong.y_mm - right.y_mm;
    const double h = wrong.heading_rad - right.heading_rad;
    wanted.xx += x * x / 2.0;
    wanted.xy += x * y / 2.0;
    wanted.yy += y * y / 2.0;
    wanted.xh += x * h / 2.0;
    wanted.hh += h * h / 2.0;
  }
  const PoseCovariance seen = odometry.covariance();
  EXPECT_NEAR(seen.xx / wanted.xx, 1.0, 0.02);
  EXPECT_NEAR(seen.xy / wanted.xy, 1.0, 0.02);
  EXPECT_NEAR(seen.yy / wanted.yy, 1.0, 0.02);
  EXPECT_NEAR(seen.xh / wanted.xh, 1.0, 0.02);
  EXPECT_NEAR(seen.hh / wanted.hh, 1.0, 0.02);
}

TEST(Odometry, MakesUpOnTheWayBackForWhatLasts) {
  Odometry odometry{{.slip_mm2_per_mm = 0.0}};
  for (int i = 0; i < 1000; ++i) odometry.step({.distance_mm = 1.0});
  const double ahead = std::sqrt(odometry.covariance().yy);
  EXPECT_NEAR(ahead, 0.02 / std::sqrt(2.0) * std::sqrt(2.0) * 1000.0 * 1000.0 / 2.0 / 258.0, 1.0);
  for (int i = 0; i < 1000; ++i) odometry.step({.distance_mm = -1.0});
  EXPECT_NEAR(std::sqrt(odometry.covariance().yy), 0.0, 1.0);
  odometry.reset({});
  EXPECT_EQ(odometry.covariance().xx, 0.0);
}

// A heading that is wrong by a tenth of a radian bends the way: it ends sooner.
TEST(Odometry, KnowsThatABentWayEndsSooner) {
  Odometry odometry{{.slip_mm2_per_mm = 0.0, .base_error = 0.0}};
  for (int i = 0; i < 4000; ++i) odometry.step({.distance_mm = 1.0});
  const double turn_rad = 0.02 * 4000.0 / 258.0;  // of one wheel that slips by 2 %
  const double sooner_mm = 4000.0 * (1.0 - std::sin(turn_rad) / turn_rad);
  EXPECT_GT(3.03 * std::sqrt(odometry.covariance().xx), sooner_mm + 0.01 * 4000.0);
}

// The sum of what is taken is the robot's whole way, for either kind of robot.
TEST(Travel, AddsUpToTheWayOfEitherKind) {
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    test::Plant plant{{.remainder = remainder}};
    WheelEstimator estimator{{.remainder = remainder}};
    double distance_mm = 0.0;
    double turn_rad = 0.0;
    const WheelSpeeds command{180.0, 220.0};
    const int window = remainder == Remainder::carried ? 1 : 40;
    for (int tick = 0; tick < 2; ++tick) {  // the first reading at rest says nothing
      plant.tick({});
      estimator.step({}, plant.read());
    }
    for (int tick = 1; tick <= 2000; ++tick) {
      plant.tick(command);
      estimator.step(command, plant.read(tick % window == 0 ? kBothAxes : Axes{}));
      const Travels travels = estimator.take_travels();
      const bool is_carried = remainder == Remainder::carried;
      const Travel& travel = is_carried ? travels.if_carried : travels.if_lost;
      distance_mm += travel.distance_mm;
      turn_rad += travel.turn_rad;
    }
    const double bound = remainder == Remainder::carried ? 1.5 : 12.0;
    EXPECT_NEAR(distance_mm, plant.distance_mm(), bound);
    EXPECT_NEAR(turn_rad, plant.turn_rad(), remainder == Remainder::carried ? 0.03 : 0.12);
  }
}

}  // namespace
}  // namespace cargobay::rt
