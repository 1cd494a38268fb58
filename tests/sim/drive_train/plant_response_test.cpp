// Each value of a plant by what it does to the wheels, against formulas of its own.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hal/sim/drive_train/odometer.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/drive_train/wheels.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

// Both wheels reach their command, with a lag of 100 ms and nothing else.
Parameters plain() {
  Parameters parameters;
  parameters.wheels.gain_left = 1.0;
  parameters.wheels.gain_right = 1.0;
  parameters.wheels.dead_band_mm_s = 0.0;
  parameters.wheels.noise_mm_s = 0.0;
  return parameters;
}
Parameters with(double WheelParameters::* member, double value) {
  Parameters parameters = plain();
  parameters.wheels.*member = value;
  return parameters;
}
double after_lag(double mm_s, double time_s) { return mm_s * (1.0 - std::exp(-time_s / 0.1)); }

TEST(DeadTime, ShiftsEachCommandInTime) {
  Wheels wheels{with(&WheelParameters::dead_time_s, 0.060)};
  wheels.set_command({200.0, 200.0});
  wheels.advance(60ms);
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0);
  EXPECT_EQ(wheels.command().left_mm_s, 200.0) << "it has been told";
  wheels.advance(20ms);
  wheels.set_command({0.0, 0.0});  // acts at 140 ms
  EXPECT_NEAR(wheels.speeds().left_mm_s, after_lag(200.0, 0.020), 1e-9);
  wheels.advance(60ms);
  EXPECT_NEAR(wheels.speeds().left_mm_s, after_lag(200.0, 0.080), 1e-9);
  wheels.advance(100ms);
  EXPECT_NEAR(wheels.speeds().left_mm_s, after_lag(200.0, 0.080) * std::exp(-1.0), 1e-9);
}

TEST(DeadTime, KeepsTheOrderOfCommandsWhenItBecomesShorter) {
  Parameters parameters = with(&WheelParameters::dead_time_s, 0.200);
  Wheels wheels{parameters};
  wheels.set_command({300.0, 300.0});
  parameters.wheels.dead_time_s = 0.0;
  wheels.set(parameters.wheels);
  wheels.set_command({-100.0, -100.0});
  wheels.advance(200ms);
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0);
  wheels.advance(3s);
  EXPECT_NEAR(wheels.speeds().left_mm_s, -100.0, 1e-6);
}

TEST(DeadTime, LosesNoLastCommandHoweverManyAreOnTheWay) {
  Wheels wheels{with(&WheelParameters::dead_time_s, 0.5)};
  for (int i = 0; i < 400; ++i) {
    wheels.set_command({i % 2 == 0 ? 400.0 : 100.0, 0.0});
    wheels.advance(1ms);
  }
  wheels.set_command({50.0, 0.0});
  wheels.advance(3s);
  EXPECT_NEAR(wheels.speeds().left_mm_s, 50.0, 1e-6);
}

// The way that a ramp a and a lag cost is command^2 / 2a + command * lag.
TEST(Ramp, CostsTheWayOfItsTriangle) {
  Wheels wheels{with(&WheelParameters::ramp_mm_s2, 300.0)};
  wheels.set_command({240.0, -120.0});
  wheels.advance(5s);
  EXPECT_NEAR(wheels.left().travel_mm(), 240.0 * 5.0 - 240.0 * 240.0 / 600.0 - 24.0, 1e-6);
  EXPECT_NEAR(wheels.right().travel_mm(), -(120.0 * 5.0 - 120.0 * 120.0 / 600.0 - 12.0), 1e-6);
  const double before_mm = wheels.left().travel_mm();
  wheels.set_command({0.0, 0.0});
  wheels.advance(5s);
  EXPECT_NEAR(wheels.left().travel_mm() - before_mm, 240.0 * 240.0 / 600.0 + 24.0, 1e-5);
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0);
}

TEST(Ramp, IsFollowedAtItsOwnAcceleration) {
  Wheels wheels{with(&WheelParameters::ramp_mm_s2, 250.0)};
  wheels.set_command({400.0, 400.0});
  wheels.advance(1s);  // ten lags: it follows the line, a lag later
  EXPECT_NEAR(wheels.speeds().left_mm_s, 250.0 * 0.9, 0.01);
}

TEST(Ramp, KeepsTheSignOfTheCountsUntilItDrivesTheOtherWay) {
  Wheels wheels{with(&WheelParameters::ramp_mm_s2, 300.0)};
  wheels.set_command({300.0, 300.0});
  wheels.advance(3s);
  const std::int64_t before = wheels.left().counts();
  wheels.set_command({-300.0, -300.0});
  wheels.advance(1s);  // it is driven at 0 now, and still rolls forward
  EXPECT_NEAR(static_cast<double>(wheels.left().counts() - before),
              (150.0 + 300.0 * 0.1 - 300.0 * 0.01) * 7.8324, 2.0);
  const std::int64_t top = wheels.left().counts();
  wheels.advance(50ms);
  EXPECT_GT(wheels.speeds().left_mm_s, 0.0);
  EXPECT_LT(wheels.left().counts(), top) << "it rolls forward, and is driven back";
}

TEST(Gain, IsOfEachWheel) {
  Parameters parameters = plain();
  parameters.wheels.gain_left = 0.6;
  parameters.wheels.gain_right = 1.15;
  Wheels wheels{parameters};
  wheels.set_command({200.0, 200.0});
  wheels.advance(3s);
  EXPECT_NEAR(wheels.speeds().left_mm_s, 120.0, 1e-6);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 230.0, 1e-6);
}

// As an owner of a later model measured: nothing up to 10 mm/s, then 11, 40, 68, 97.
TEST(Steps, BeginAtTheDeadBand) {
  Parameters parameters = plain();
  parameters.wheels.dead_band_mm_s = 11.0;
  parameters.wheels.step_mm_s = 28.5;
  Wheels wheels{parameters};
  for (int command = 0; command <= 110; ++command) {
    wheels.set_command({static_cast<double>(command), -static_cast<double>(command)});
    wheels.advance(4s);
    const double expected = command <= 10   ? 0.0
                            : command <= 25 ? 11.0
                            : command <= 53 ? 39.5
                            : command <= 82 ? 68.0
                                            : 96.5;
    if (command == 110) continue;
    EXPECT_NEAR(wheels.speeds().left_mm_s, expected, 0.01) << command;
    EXPECT_NEAR(wheels.speeds().right_mm_s, -expected, 0.01) << command;
  }
  EXPECT_NEAR(wheels.speeds().left_mm_s, 96.5, 0.01);
}

TEST(Stiction, HoldsAWheelThatStandsAndNotOneThatTurns) {
  Wheels wheels{with(&WheelParameters::stiction_mm_s, 40.0)};
  wheels.set_command({39.0, 41.0});
  wheels.advance(2s);
  EXPECT_EQ(wheels.left().travel_mm(), 0.0);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 41.0, 1e-6);
  wheels.set_command({39.0, 15.0});
  wheels.advance(2s);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 15.0, 1e-3) << "less keeps it turning";
  wheels.set_command({100.0, -15.0});
  wheels.advance(2s);
  EXPECT_NEAR(wheels.speeds().left_mm_s, 100.0, 1e-3);
  EXPECT_EQ(wheels.speeds().right_mm_s, 0.0) << "it stuck when it turned around";
  wheels.set_command({0.0, 0.0});
  wheels.advance(2s);
  wheels.set_command({39.0, 0.0});
  wheels.advance(2s);
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0) << "it stands again";
}

// An exponential never ends; friction ends it at 1 mm/s.
TEST(Stiction, BringsACoastingWheelToRest) {
  Wheels wheels{with(&WheelParameters::stiction_mm_s, 40.0)};
  wheels.set_command({200.0, 0.0});
  wheels.advance(5s);
  const double travel_mm = wheels.left().travel_mm();
  wheels.set_command({0.0, 0.0});
  wheels.advance(rt::Duration{std::llround(0.1e9 * std::log(200.0)) + 1000});
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0);
  EXPECT_NEAR(wheels.left().travel_mm() - travel_mm, 199.0 * 0.1, 1e-6);
}

// On a ramp a wheel breaks loose when the ramp has come so far: at 40 of 80 mm/s.
TEST(Stiction, DelaysARampedStart) {
  Parameters parameters = with(&WheelParameters::stiction_mm_s, 40.0);
  parameters.wheels.ramp_mm_s2 = 80.0;
  Wheels wheels{parameters};
  wheels.set_command({200.0, -200.0});
  wheels.advance(500ms);
  EXPECT_EQ(wheels.left().travel_mm(), 0.0);
  EXPECT_EQ(wheels.right().travel_mm(), 0.0);
  wheels.advance(150ms);
  // From standing, target 40 + 80 t.
  const double expected = 40.0 + 80.0 * (0.15 - 0.1) - (40.0 - 80.0 * 0.1) * std::exp(-1.5);
  EXPECT_NEAR(wheels.speeds().left_mm_s, expected, 1e-9);
  EXPECT_NEAR(wheels.speeds().right_mm_s, -expected, 1e-9);
}

TEST(Slip, MovesTheFloorLessThanTheWheel) {
  Parameters parameters = plain();
  parameters.wheels.slip_left = 0.1;
  parameters.wheels.slip_right = 0.1;
  Wheels wheels{parameters};
  wheels.set_command({200.0, 200.0});
  wheels.advance(5s);
  const double turned_mm = 200.0 * (5.0 - 0.1);
  EXPECT_NEAR(wheels.left().travel_mm(), turned_mm, 1e-6);
  EXPECT_NEAR(static_cast<double>(wheels.left().counts()), turned_mm * 7.8324, 1.0);
  EXPECT_NEAR(wheels.pose().x_mm, 0.9 * turned_mm, 1e-6);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 180.0, 1e-6);
}

TEST(Slip, OfOneWheelTurnsTheRobot) {
  Wheels wheels{with(&WheelParameters::slip_left, 0.2)};
  wheels.set_command({100.0, 100.0});
  wheels.advance(2s);
  EXPECT_NEAR(wheels.pose().heading_rad, 0.2 * 100.0 * 1.9 / 258.0, 1e-9);
}

TEST(MissedSteps, AreMissingInDistanceAndAngle) {
  const Parameters parameters = with(&WheelParameters::missed_right, 0.5);
  Wheels wheels{parameters};
  Odometer odometer{parameters};
  wheels.set_command({200.0, 200.0});
  wheels.advance(5s);
  odometer.latch(wheels.left().counts(), wheels.right().counts());
  EXPECT_NEAR(odometer.distance_mm(), 0.75 * 980.0, 0.2);
  EXPECT_NEAR(odometer.angle_deg(), -0.5 * 980.0 / 258.0 * 180.0 / std::numbers::pi, 0.1);
  EXPECT_NEAR(wheels.pose().heading_rad, 0.0, 1e-12) << "it drives straight";
}

TEST(TrueSign, CountsCoastingTheWayItGoes) {
  Parameters parameters = plain();
  parameters.wheels.sign = CounterSign::true_one;
  Wheels wheels{parameters};
  for (const WheelSpeeds command : {WheelSpeeds{300.0, 0.0}, {-300.0, 0.0}, {80.0, -200.0}}) {
    wheels.set_command(command);
    wheels.advance(73ms);
    for (const Wheel& wheel : {wheels.left(), wheels.right()})
      EXPECT_NEAR(static_cast<double>(wheel.counts()), wheel.travel_mm() * 7.8324, 1.0);
  }
}

Parameters counting() {
  Parameters parameters = plain();
  EXPECT_EQ(set_plant("counting noise 0", parameters.wheels), "");
  return parameters;
}

// Of second order: it overshoots, and comes to the command whatever the load.
TEST(Counting, OvershootsAndTakesALoadAway) {
  Wheels wheels{counting()};
  wheels.set_command({200.0, 200.0});
  double highest_mm_s = 0.0;
  for (int i = 0; i < 200; ++i) {
    wheels.advance(15ms);
    highest_mm_s = std::max(highest_mm_s, wheels.speeds().left_mm_s);
  }
  EXPECT_GT(highest_mm_s, 206.0);
  EXPECT_LT(highest_mm_s, 260.0);
  const auto mean_mm_s = [&wheels] {
    const double before_mm = wheels.left().travel_mm();
    wheels.advance(3s);
    return (wheels.left().travel_mm() - before_mm) / 3.0;
  };
  EXPECT_NEAR(mean_mm_s(), 200.0, 0.5);
  wheels.set_load(0.7, 1.0);
  wheels.advance(150ms);
  EXPECT_LT(wheels.speeds().left_mm_s, 185.0);
  wheels.advance(2s);
  EXPECT_NEAR(mean_mm_s(), 200.0, 0.5);
}

// Its two differential equations by small steps, with the counts taken as they are.
TEST(Counting, IsAMotorWithAControllerThatSeesSteps) {
  const Parameters parameters = counting();
  Wheels wheels{parameters};
  wheels.set_command({150.0, 150.0});
  double speed = 0.0;
  double travel = 0.0;
  double integral = 0.0;
  double drive = 0.0;
  double counted = 0.0;
  const double step_s = 1e-5;
  for (int tick = 1; tick <= 100; ++tick) {
    for (int i = 0; i < 1500; ++i) {
      const double former = speed;
      speed += step_s * (drive - speed) / parameters.wheels.lag_s;
      travel += 0.5 * step_s * (former + speed);
    }
    const double counts = std::floor(travel * 7.8324);
    const double error = 150.0 - (counts - counted) / 7.8324 / 0.015;
    counted = counts;
    integral += parameters.wheels.inner_i_per_s * 0.015 * error;
    drive = parameters.wheels.inner_p * error + integral;
    wheels.advance(15ms);
    // A step more or less in a tick is 8.5 mm/s of error.
    ASSERT_NEAR(wheels.speeds().left_mm_s, speed, 5.0) << tick;
  }
  EXPECT_NEAR(wheels.left().travel_mm(), travel, 1.0);
}

TEST(Counting, RunsAwayWhenItsEncoderIsDead) {
  Parameters parameters = counting();
  parameters.wheels.missed_left = 1.0;
  Wheels wheels{parameters};
  wheels.set_command({100.0, 100.0});
  wheels.advance(10s);
  EXPECT_NEAR(wheels.speeds().left_mm_s, InnerController::kFullDriveMmPerSec, 1.0);
  wheels.set_command({0.0, 0.0});
  wheels.advance(5s);
  EXPECT_EQ(wheels.speeds().left_mm_s, 0.0) << "its motor is off";
}

TEST(Changes, WhileDrivingKeepSpeedAndWay) {
  Parameters parameters = plain();
  Wheels wheels{parameters};
  wheels.set_command({200.0, 200.0});
  wheels.advance(100ms);
  const double speed_mm_s = wheels.speeds().left_mm_s;
  const double travel_mm = wheels.left().travel_mm();
  parameters.wheels.lag_s = 0.5;
  parameters.wheels.gain_left = 0.5;
  wheels.set(parameters.wheels);
  EXPECT_EQ(wheels.speeds().left_mm_s, speed_mm_s);
  EXPECT_EQ(wheels.left().travel_mm(), travel_mm);
  wheels.advance(250ms);
  EXPECT_NEAR(wheels.speeds().left_mm_s, 100.0 + (speed_mm_s - 100.0) * std::exp(-0.5), 1e-9);
  EXPECT_NEAR(wheels.speeds().right_mm_s, 200.0 + (speed_mm_s - 200.0) * std::exp(-0.5), 1e-9);
}

TEST(Changes, ToACountingPlantAreSmooth) {
  Parameters parameters = plain();
  Wheels wheels{parameters};
  wheels.set_command({200.0, 200.0});
  wheels.advance(2s + 7ms);
  wheels.set(counting().wheels);
  for (int i = 0; i < 100; ++i) {
    wheels.advance(15ms);
    EXPECT_NEAR(wheels.speeds().left_mm_s, 200.0, 15.0);
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
