#include "rt/velocity_controller.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using Wheel = VelocityController::Wheel;
using Wish = VelocityController::Wish;

const VelocityController kController{VelocityController::Parameters{}};

double command(const Wish& wish, const Wheel& wheel) { return kController.command(wish, wheel); }
// At a constant set speed.
Wish steadily(double set_mm_s) {
  return {.asked_mm_s = set_mm_s,
          .set_mm_s = set_mm_s,
          .ahead_mm_s = set_mm_s,
          .target_mm_s = set_mm_s};
}
// On the way to a target.
Wish under_way(double set_mm_s, double rate_mm_s2, double target_mm_s) {
  return {.asked_mm_s = set_mm_s,
          .set_mm_s = set_mm_s,
          .ahead_mm_s = set_mm_s,
          .rate_mm_s2 = rate_mm_s2,
          .target_mm_s = target_mm_s};
}

TEST(VelocityController, SendsTheSetSpeedThroughTheGain) {
  EXPECT_DOUBLE_EQ(command(steadily(200.0), {.gain = 1.0, .speed_mm_s = 200.0}), 200.0);
  EXPECT_DOUBLE_EQ(command(steadily(200.0), {.gain = 0.8, .speed_mm_s = 200.0}), 250.0);
  EXPECT_DOUBLE_EQ(command(steadily(-90.0), {.gain = 0.9, .speed_mm_s = -90.0}), -100.0);
}

TEST(VelocityController, LeadsByTheLagWhileTheSetSpeedChanges) {
  EXPECT_DOUBLE_EQ(command(under_way(200.0, 1000.0, 400.0), {.lag_s = 0.1, .speed_mm_s = 200.0}),
                   300.0);
}

// The error is that of now; the drive is for when the command acts.
TEST(VelocityController, SendsWhatIsWantedWhenItActs) {
  const Wish wish{
      .asked_mm_s = 200.0, .set_mm_s = 200.0, .ahead_mm_s = 250.0, .target_mm_s = 400.0};
  EXPECT_DOUBLE_EQ(command(wish, {.proportional = 0.5, .speed_mm_s = 200.0}), 250.0);
  EXPECT_DOUBLE_EQ(command(wish, {.proportional = 0.5, .speed_mm_s = 180.0}), 260.0);
}

// A wheel that falls short, and one that is slow just now.
TEST(VelocityController, MakesUpForADisturbanceAndAnError) {
  EXPECT_DOUBLE_EQ(command(steadily(200.0), {.disturbance_mm_s = -20.0, .speed_mm_s = 200.0}),
                   220.0);
  EXPECT_DOUBLE_EQ(command(steadily(200.0), {.proportional = 0.5, .speed_mm_s = 180.0}), 210.0);
  EXPECT_DOUBLE_EQ(
      command(steadily(200.0),
              {.gain = 0.8, .proportional = 0.5, .disturbance_mm_s = 4.0, .speed_mm_s = 180.0}),
      (200.0 + 10.0 - 4.0) / 0.8);
}

TEST(VelocityController, StaysWithinTheLimit) {
  const Wheel wheel{.lag_s = 0.1};
  EXPECT_EQ(command(under_way(490.0, 1000.0, 500.0), wheel), 500.0);
  EXPECT_EQ(command(under_way(-490.0, -1000.0, -500.0), wheel), -500.0);
  const VelocityController narrow{{.max_command_mm_s = 300.0}};
  EXPECT_EQ(narrow.command(steadily(400.0), wheel), 300.0);
}

// If the wheel is as strong as is still likely, it overshoots by no more than it may.
TEST(VelocityController, IsCautiousWhileTheGainIsNotKnown) {
  for (const double set_mm_s : {20.0, 100.0, 166.0, 300.0}) {
    for (const double gain_sd : {0.01, 0.05, 0.1, 0.2}) {
      const Wheel wheel{.gain = 0.92, .gain_sd = gain_sd, .speed_mm_s = set_mm_s};
      const double strongest = 0.92 + 1.3 * gain_sd;
      const double may = std::max(0.06 * set_mm_s, 10.0);
      const double sent = command(steadily(set_mm_s), wheel);
      EXPECT_LE(strongest * sent, set_mm_s + may + 1e-9) << set_mm_s << ' ' << gain_sd;
      EXPECT_LE(sent, set_mm_s / 0.92 + 1e-9);
      // And no more cautious than that.
      if (0.92 / strongest > set_mm_s / (set_mm_s + may)) {
        EXPECT_DOUBLE_EQ(sent, set_mm_s / 0.92);
      } else {
        EXPECT_GE(strongest * sent, set_mm_s);
      }
    }
  }
}

// The way up counts as the speed that it leads to, and a way down as the speed where it began.
TEST(VelocityController, IsCautiousForTheSpeedThatIsToCome) {
  const Wheel wheel{.gain = 0.92, .gain_sd = 0.1};
  const double at_target = command(steadily(300.0), wheel) / 300.0;
  EXPECT_NEAR(command(under_way(10.0, 0.0, 300.0), wheel) / 10.0, at_target, 1e-9);
  EXPECT_NEAR(command(under_way(300.0, 0.0, 0.0), wheel) / 300.0, at_target, 1e-9);
  EXPECT_GT(command(steadily(10.0), wheel) / 10.0, at_target) << "10 mm/s may be overshot";
}

// Its counter would run backwards.
TEST(VelocityController, NeverCommandsAgainstTheWayThatTheWheelRolls) {
  for (const double sign : {1.0, -1.0}) {
    const Wheel rolling{.lag_s = 0.1, .proportional = 0.5, .speed_mm_s = sign * 120.0};
    EXPECT_EQ(command(under_way(sign * 50.0, sign * -1000.0, 0.0), rolling), 0.0) << "braking";
    EXPECT_EQ(command(steadily(sign * -200.0), rolling), 0.0) << "reversing";
    const Wheel slow{.speed_mm_s = sign * 5.0};
    EXPECT_EQ(command(steadily(sign * -200.0), slow), sign * -200.0)
        << "too slow to know the direction";
  }
}

// The course may ask for a little more than was set, but not beyond that bound.
TEST(VelocityController, IsBoundByWhatWasAskedFor) {
  const Wheel weak{.gain = 0.05};
  const Wish taken_back{
      .asked_mm_s = 100.0, .set_mm_s = 108.0, .ahead_mm_s = 108.0, .target_mm_s = 100.0};
  EXPECT_EQ(command(taken_back, weak), VelocityController::most_mm_s(100.0));
}

// Whatever it is told of the wheel.
TEST(VelocityController, NeverDrivesTheStrongestMotorTooFast) {
  std::mt19937 random{3};
  const auto draw = [&random](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  int at_the_cap = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Wheel wheel{.gain = draw(0.05, 1.5),
                      .gain_sd = draw(0.0, 0.3),
                      .lag_s = 0.5,
                      .proportional = draw(0.0, 0.7),
                      .disturbance_mm_s = draw(-600.0, 600.0),
                      .speed_mm_s = draw(-600.0, 600.0)};
    const double set_mm_s = draw(-400.0, 400.0);
    const double most_mm_s = 1.7 * std::abs(set_mm_s) + 50.0;
    const double fastest_mm_s = 1.15 * std::abs(command(steadily(set_mm_s), wheel));
    ASSERT_LE(fastest_mm_s, most_mm_s + 1e-9) << i;
    if (fastest_mm_s > most_mm_s - 1e-6) ++at_the_cap;
  }
  EXPECT_GT(at_the_cap, 1000) << "the bound is what holds it";
}

}  // namespace
}  // namespace cargobay::rt
