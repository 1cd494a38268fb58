// The commands plant, load and stuck, while the robot drives.
#include "hal/sim/remote/wheel_controls.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/control.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

Parameters quiet() {
  Parameters parameters = without_noise();
  parameters.wheels.gain_left = 1.0;
  parameters.wheels.gain_right = 1.0;
  return parameters;
}

// In Full, at 200 mm/s for 2 s.
struct Driving : Robot {
  Driving() : Robot{quiet()} {
    send({128, 132, 145, 0, 200, 0, 200});
    wait(2s);
  }
  std::string say(std::string_view line) { return control(line, link.cable()); }
  WheelSpeeds speeds() { return device.truth().speeds; }
  bool state_has(const std::string& part) { return say("state").find(part) != std::string::npos; }
};

TEST(PlantCommand, ChangesTheWheelsWhileTheyTurn) {
  Driving robot;
  EXPECT_EQ(robot.say("plant weak noise 0"), "ok");
  EXPECT_NEAR(robot.speeds().left_mm_s, 200.0, 1e-3) << "without a jerk";
  robot.wait(2s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 120.0, 1e-3);
  EXPECT_NEAR(robot.speeds().right_mm_s, 130.0, 1e-3);
  EXPECT_EQ(robot.say("plant gain-left 1.15"), "ok");
  robot.wait(2s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 230.0, 1e-3);
  EXPECT_NEAR(robot.speeds().right_mm_s, 130.0, 1e-3);
}

TEST(PlantCommand, ActsAtATime) {
  Driving robot;
  EXPECT_EQ(robot.say("at 3 plant slip-left 0.5"), "ok");
  EXPECT_EQ(robot.say("at 3 plant lag 100"),
            "error: lag is in seconds, 0.001 to 1; milliseconds? did you mean 0.1");
  robot.wait(3s - robot.device.now());
  EXPECT_NEAR(robot.device.truth().pose.heading_rad, 0.0, 1e-9);
  robot.wait(1s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 100.0, 1e-3);
  EXPECT_NEAR(robot.device.truth().pose.heading_rad, 100.0 / 258.0, 1e-3);
}

TEST(PlantCommand, ReachesEncodersAndOdometer) {
  Driving robot;
  (void)robot.ask({142, 2});
  EXPECT_EQ(robot.say("plant missed-left 1 missed-right 1"), "ok");
  robot.wait(1s);
  EXPECT_NEAR(word(robot.ask({142, 19}), 0), 0, 6);
  EXPECT_EQ(robot.say("plant missed-left 0.5 missed-right 0.5"), "ok");
  robot.wait(1s);
  EXPECT_NEAR(word(robot.ask({142, 19}), 0), 100, 6);
}

TEST(PlantCommand, SaysWhatIsThereAndWhatIsWrong) {
  Driving robot;
  EXPECT_EQ(robot.say("plant"), "error: the usage is 'plant [NAME] [VALUE NUMBER]...'");
  const std::string answer = robot.say("plant ?");
  EXPECT_TRUE(answer.starts_with("error: unknown plant or value '?'")) << answer;
  for (const Plant& plant : plants())
    EXPECT_NE(answer.find(" " + std::string{plant.name}), std::string::npos) << answer;
  EXPECT_EQ(robot.say("plant slow lag 100"),
            "error: lag is in seconds, 0.001 to 1; milliseconds? did you mean 0.1");
  EXPECT_EQ(robot.device.parameters().wheels, quiet().wheels) << "nothing has changed";
}

TEST(LoadCommand, LeavesThisPartOfTheGain) {
  Driving robot;
  EXPECT_EQ(robot.say("load 0.75"), "ok");
  robot.wait(2s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 150.0, 1e-3);
  EXPECT_NEAR(robot.speeds().right_mm_s, 150.0, 1e-3);
  EXPECT_EQ(robot.say("load 1 right"), "ok");
  robot.wait(2s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 150.0, 1e-3);
  EXPECT_NEAR(robot.speeds().right_mm_s, 200.0, 1e-3);
  EXPECT_TRUE(robot.state_has(R"("load":{"left":0.750,"right":1.000})"));
}

TEST(LoadCommand, EndsByItself) {
  Driving robot;
  robot.to_tick();
  EXPECT_EQ(robot.say("load 0.5 both 150"), "ok");
  robot.wait(150ms);
  EXPECT_NEAR(robot.speeds().left_mm_s, 100.0 + 100.0 * std::exp(-1.5), 1e-3);
  robot.wait(100ms);
  EXPECT_NEAR(robot.speeds().left_mm_s, 200.0 - 100.0 * (1.0 - std::exp(-1.5)) * std::exp(-1.0),
              1e-3);
  EXPECT_EQ(robot.say("load 0.5 left 150"), "ok");
  EXPECT_EQ(robot.say("load 0.8 left"), "ok");  // the later one holds
  robot.wait(3s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 160.0, 1e-3);
}

TEST(StuckCommand, HoldsAWheelWithItsOvercurrentBit) {
  Driving robot;
  robot.to_tick();
  EXPECT_EQ(robot.say("stuck left 150"), "ok");
  EXPECT_EQ(robot.speeds().left_mm_s, 0.0);
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0b10000}));
  EXPECT_TRUE(robot.state_has(R"("stuck":{"left":true,"right":false})"));
  EXPECT_NEAR(robot.speeds().right_mm_s, 200.0, 1e-3);
  robot.wait(2s);
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0}));
  EXPECT_NEAR(robot.speeds().left_mm_s, 200.0, 1e-3);
  EXPECT_EQ(robot.say("stuck both"), "ok");
  robot.wait(1s);
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0b11000}));
  EXPECT_EQ(robot.say("stuck none"), "ok");
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0}));
}

TEST(StuckCommand, DrawsNothingWhileTheMotorIsOff) {
  Driving robot;
  robot.send({145, 0, 0, 0, 0});
  EXPECT_EQ(robot.say("stuck right"), "ok");
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0}));
}

TEST(WheelCommands, RefuseWhatMakesNoSense) {
  Driving robot;
  for (const char* line :
       {"load", "load x", "load -0.1", "load 2.1", "load nan", "load 75", "load 0.5 middle",
        "load 0.5 left -1", "load 0.5 left 3600000.1", "load 0.5 left 10 10", "load left 0.5"}) {
    EXPECT_EQ(robot.say(line), "error: the usage is 'load PART [left|right|both] [MS]'") << line;
  }
  for (const char* line : {"stuck", "stuck middle", "stuck left x", "stuck left -1", "stuck none 5",
                           "stuck left 10 10"}) {
    EXPECT_EQ(robot.say(line), "error: the usage is 'stuck none|left|right|both [MS]'") << line;
  }
  robot.wait(1s);
  EXPECT_NEAR(robot.speeds().left_mm_s, 200.0, 1e-3);
}

TEST(State, TellsThePlantInForce) {
  Driving robot;
  EXPECT_EQ(robot.say("plant carpet"), "ok");
  EXPECT_TRUE(robot.state_has(
      R"("plant":{"name":"carpet","response":"first-order","lag":0.15,"dead_time":0,"ramp":250,)"));
  EXPECT_EQ(robot.say("plant counting dead-time 0.06"), "ok");
  EXPECT_TRUE(robot.state_has(R"("plant":{"name":null,"response":"counting","lag":0.15,)"));
  EXPECT_TRUE(robot.state_has(R"("dead_time":0.06,)"));
  EXPECT_TRUE(robot.state_has(R"("sign":"commanded",)"));
}

}  // namespace
}  // namespace cargobay::hal::sim
