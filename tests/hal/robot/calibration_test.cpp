#include "hal/robot/calibration.hpp"

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

Result<CalibrationResult> calibrate(const sim::Parameters& robot, double speed_mm_s = 200.0) {
  test::VirtualDrive drive{robot};
  Calibration calibration{speed_mm_s};
  ControlCycle::Parameters parameters;
  Calibration::prepare(parameters);
  const int frames = static_cast<int>(Calibration::duration_s() / 0.015) + 2;
  const test::DriveResult result =
      drive.run(frames, [&](double seconds) { return calibration.at(seconds); }, parameters);
  EXPECT_EQ(result.end, CycleEnd::asked);
  for (const test::Tick& tick : result.ticks) calibration.see(tick.state);
  const double delay_s =
      rt::seconds(oi::wire_time(oi::kCreate.frame_bytes + oi::kDriveDirectBytes, 57600));
  return calibration.result(delay_s);
}

// Each of these robots is different, and none is what the loop assumes.
TEST(Calibration, FindsOutWhatTheRobotIs) {
  struct Case {
    double wheel_base_mm;
    double lag_s;
    double gain_left;
    double gain_right;
    sim::Remainder remainder;
    std::uint64_t seed;
  };
  for (const Case& robot : {Case{258.0, 0.100, 0.94, 0.90, sim::Remainder::carried, 1},
                            Case{262.5, 0.060, 0.88, 0.97, sim::Remainder::carried, 2},
                            Case{250.0, 0.200, 1.00, 0.85, sim::Remainder::carried, 3},
                            Case{258.0, 0.100, 0.94, 0.90, sim::Remainder::lost, 4},
                            Case{265.0, 0.150, 0.90, 0.98, sim::Remainder::lost, 5}}) {
    sim::Parameters parameters{.remainder = robot.remainder, .seed = robot.seed};
    parameters.wheels.wheel_base_mm = robot.wheel_base_mm;
    parameters.wheels.lag_s = robot.lag_s;
    parameters.wheels.gain_left = robot.gain_left;
    parameters.wheels.gain_right = robot.gain_right;
    const auto result = calibrate(parameters);
    ASSERT_TRUE(result) << result.failure().message;
    const bool carried = robot.remainder == sim::Remainder::carried;
    EXPECT_NEAR(result->wheel_base_mm, robot.wheel_base_mm, carried ? 1.5 : 3.0);
    EXPECT_NEAR(result->lag_s, robot.lag_s, 0.015);
    EXPECT_NEAR(result->gain_left, robot.gain_left, 0.01);
    EXPECT_NEAR(result->gain_right, robot.gain_right, 0.01);
    EXPECT_EQ(result->remainder,
              carried ? rt::RemainderBelief::carried : rt::RemainderBelief::lost);
  }
}

TEST(Calibration, SaysWhereTheRobotDoesNotMove) {
  test::VirtualDrive drive{{}};
  drive.device.set_wheels_blocked(true, true);
  Calibration calibration{200.0};
  ControlCycle::Parameters parameters;
  Calibration::prepare(parameters);
  const auto result = drive.run(
      static_cast<int>(Calibration::duration_s() / 0.015) + 2,
      [&](double seconds) { return calibration.at(seconds); }, parameters);
  for (const test::Tick& tick : result.ticks) calibration.see(tick.state);
  const auto found = calibration.result(0.0);
  ASSERT_FALSE(found);
  const std::string& message = found.failure().message;
  EXPECT_TRUE(message.find("hardly turned") != std::string::npos ||
              message.find("wheels turn freely") != std::string::npos)
      << message;
}

TEST(Calibration, SaysWhereTheDriveEndedEarly) {
  const auto found = Calibration{200.0}.result(0.0);
  ASSERT_FALSE(found);
  EXPECT_NE(found.failure().message.find("ended early"), std::string::npos);
}

}  // namespace
}  // namespace cargobay::hal
