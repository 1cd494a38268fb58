// OI p. 10 and 17: anything that asks for too much current gets its limit, and packet 14 says so.
#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct InFull : Robot {
  InFull() : Robot{ideal_wheels()} { send({128, 132}); }
  // The current over the last tick.
  double drawn_ma() {
    to_tick();
    return -device.battery().current_ma();
  }
};

TEST(Overload, StopsAWheelUntilItIsOver) {
  InFull robot;
  robot.send({145, 0, 200, 0, 200});
  robot.wait(100ms);
  robot.device.inputs().overcurrent_left_wheel = true;
  robot.wait(100ms);
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0b10000}));
  EXPECT_EQ(robot.device.truth().speeds.left_mm_s, 0.0);
  EXPECT_NEAR(robot.device.truth().speeds.right_mm_s, 200.0, 1e-6);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 200.0) << "it is still told to";
  robot.device.inputs().overcurrent_left_wheel = false;
  robot.wait(100ms);
  EXPECT_NEAR(robot.device.truth().speeds.left_mm_s, 200.0, 1e-6);
}

TEST(Overload, IsWhatAWheelThatIsHeldDraws) {
  InFull robot;
  robot.device.set_wheels_blocked(false, true);
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0})) << "its motor is off";
  const double idle_ma = robot.drawn_ma();
  robot.send({145, 0, 200, 0, 0});
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0b1000}));
  EXPECT_NEAR(robot.drawn_ma() - idle_ma, 1000.0, 1e-6);
  robot.send({145, 0, 0, 0, 0});
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0}));
}

TEST(Overload, LimitsADriverToWhatItCanCarry) {
  InFull robot;
  robot.device.inputs().overcurrent_low_side_driver = {true, true, true};
  const double idle_ma = robot.drawn_ma();
  EXPECT_EQ(robot.device.low_side_driver_ma(), (std::array<double, 3>{})) << "they are off";
  robot.send({138, 7});
  robot.to_tick();
  EXPECT_EQ(robot.device.low_side_driver_ma(), (std::array<double, 3>{500.0, 500.0, 1600.0}));
  EXPECT_NEAR(robot.drawn_ma() - idle_ma, 2600.0, 1e-6);
  robot.device.inputs().overcurrent_low_side_driver = {};
  robot.to_tick();
  for (const double driver_ma : robot.device.low_side_driver_ma()) EXPECT_LT(driver_ma, 500.0);
}

}  // namespace
}  // namespace cargobay::hal::sim
