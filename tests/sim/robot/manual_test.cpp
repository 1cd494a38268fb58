// Statements of the manual that only the virtual Create's true state can show
// (docs/conformance.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "hal/sim/world/world.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers
using oi::Mode;

void hold_play_while_switching_on(Robot& robot) {
  robot.device.press_power();
  robot.device.inputs().play_button = true;
  robot.device.press_power();
  robot.wait(4100ms);
  robot.device.inputs().play_button = false;
}

void empty_and_change_the_battery(Robot& robot) {
  robot.device.battery().set_charge_mah(0.0);
  robot.to_tick();
  EXPECT_EQ(robot.device.power(), Power::off);
  robot.device.battery().set_charge_mah(2000.0);
  robot.device.press_power();
  robot.wait(5s);
}

TEST(RateByPlay, EndsWithTheBattery) {  // OI p. 5
  Robot robot;
  hold_play_while_switching_on(robot);
  ASSERT_EQ(robot.device.baud(), 19200U);
  robot.device.brown_out();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(RateByPlay, EndsWithAnEmptyBattery) {  // OI p. 5
  Robot robot;
  hold_play_while_switching_on(robot);
  ASSERT_EQ(robot.device.baud(), 19200U);
  empty_and_change_the_battery(robot);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(RateByPlay, YieldsToABaudCommand) {  // OI p. 5
  Robot robot;
  hold_play_while_switching_on(robot);
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.send({128, 129, 5});
  robot.wait(200ms);
  EXPECT_EQ(robot.device.baud(), 9600U);
}

TEST(RateByCommand, EndsWithTheBattery) {  // OI p. 7
  Robot robot;
  robot.send({128, 129, 5});
  robot.wait(200ms);
  ASSERT_EQ(robot.device.baud(), 9600U);
  robot.device.brown_out();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(RateByCommand, EndsWithAnEmptyBattery) {  // OI p. 7
  Robot robot;
  robot.send({128, 129, 5});
  robot.wait(200ms);
  ASSERT_EQ(robot.device.baud(), 9600U);
  empty_and_change_the_battery(robot);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(UnderControl, FullBeginsWithTheLedsOff) {  // OI p. 6
  Robot robot;
  robot.send({128, 131, 139, 10, 255, 128, 128, 132});
  EXPECT_FALSE(robot.device.actuators().lit(oi::Led::play));
  EXPECT_FALSE(robot.device.actuators().lit(oi::Led::advance));
  EXPECT_EQ(robot.device.actuators().leds.power_intensity, 0);
}

TEST(UnderControl, TheRobotWaitsAndReactsToNothing) {  // OI p. 6
  for (const std::uint8_t mode : Bytes{131, 132}) {
    Robot robot;
    robot.send({128, mode});
    for (const auto set :
         {+[](Inputs& in) { in.bump_left = true; }, +[](Inputs& in) { in.bump_right = true; },
          +[](Inputs& in) { in.wall = true; }, +[](Inputs& in) { in.virtual_wall = true; },
          +[](Inputs& in) { in.infrared = 130; },
          +[](Inputs& in) { in.digital = {true, true, true, true}; },
          +[](Inputs& in) { in.play_button = true; },
          +[](Inputs& in) { in.advance_button = true; }}) {
      robot.device.inputs() = {};
      set(robot.device.inputs());
      robot.wait(200ms);
      EXPECT_EQ(robot.device.commanded(), WheelSpeeds{});
      EXPECT_FALSE(robot.device.demos().running());
      EXPECT_FALSE(robot.device.actuators().lit(oi::Led::play));
      EXPECT_EQ(robot.device.sounding(), 0);
      EXPECT_EQ(robot.ask({142, 35}), (Bytes{static_cast<std::uint8_t>(mode - 129)}));
    }
  }
}

TEST(UnderControl, SafeEndsCharging) {  // OI p. 6
  Robot robot;
  robot.send({128});
  robot.device.inputs().home_base = true;
  robot.wait(1s);
  ASSERT_TRUE(robot.device.battery().charging());
  robot.send({131});
  robot.to_tick();
  EXPECT_EQ(robot.device.mode(), Mode::safe);
  EXPECT_FALSE(robot.device.battery().charging());
}

TEST(OutputsOfTheManual, HaveABitEach) {  // OI p. 10
  Robot robot;
  robot.send({128, 132});
  for (std::size_t output = 0; output < 3; ++output) {
    const auto bit = static_cast<std::uint8_t>(1U << output);
    robot.send({147, bit});
    EXPECT_EQ(robot.device.actuators().digital_outputs, bit);
    robot.send({138, bit});
    std::array<std::uint8_t, 3> drivers{};
    drivers.at(output) = 128;
    EXPECT_EQ(robot.device.actuators().low_side_drivers, drivers);
  }
  robot.send({147, 0, 138, 0});
  EXPECT_EQ(robot.device.actuators().digital_outputs, 0);
  EXPECT_EQ(robot.device.actuators().low_side_drivers, (std::array<std::uint8_t, 3>{}));
}

struct DemoRobot : Robot {
  explicit DemoRobot(std::uint8_t number) : Robot{ideal_wheels()} {
    send({128, 136, number});
    wait(200ms);  // the beep at Start is over
  }
  // The radius of the circle that the wheels are told to drive; 0 in place.
  double radius_mm() const {
    const WheelSpeeds speeds = device.commanded();
    return 129.0 * (speeds.right_mm_s + speeds.left_mm_s) / (speeds.right_mm_s - speeds.left_mm_s);
  }
};

TEST(DemosOfTheManual, SpotSpiralsOutwardThenInward) {  // OI p. 8
  DemoRobot robot{2};
  double before_mm = robot.radius_mm();
  EXPECT_GT(before_mm, 0.0);
  for (int second = 5; second <= 25; second += 5) {
    robot.wait(5s);
    EXPECT_GT(robot.radius_mm(), before_mm) << second;
    before_mm = robot.radius_mm();
  }
  robot.wait(5s);
  before_mm = robot.radius_mm();
  for (int second = 35; second <= 55; second += 5) {
    robot.wait(5s);
    EXPECT_LT(robot.radius_mm(), before_mm) << second;
    before_mm = robot.radius_mm();
  }
}

TEST(DemosOfTheManual, MouseFollowsTheWallsAroundARoom) {  // OI p. 8
  const Result<World> world = World::parse(
      "wall 0 0 2000 0\nwall 2000 0 2000 2000\nwall 2000 2000 0 2000\nwall 0 2000 0 0\n"
      "start 1000 1000 0\n");
  ASSERT_TRUE(world);
  Robot robot{ideal_wheels()};
  inhabit(robot.device, *world);
  robot.send({128, 136, 3});
  std::set<int> walls;
  bool found = false;
  for (int i = 0; i < 900; ++i) {
    robot.wait(100ms);
    const WorldPose pose = robot.device.truth().pose;
    const std::array<double, 4> away{pose.y_mm, 2000.0 - pose.x_mm, 2000.0 - pose.y_mm, pose.x_mm};
    const auto* const nearest = std::min_element(away.begin(), away.end());
    found = found || robot.device.seen().bump_left || robot.device.seen().bump_right;
    if (!found) continue;
    EXPECT_LT(*nearest, 600.0) << "it keeps to the walls, and off the middle at 1000";
    walls.insert(static_cast<int>(nearest - away.begin()));
  }
  EXPECT_TRUE(found);
  EXPECT_EQ(walls.size(), 4U) << "around the room";
}

TEST(DemosOfTheManual, WimpDrivesAwayFromWhatItMeets) {  // OI p. 8
  DemoRobot robot{5};
  robot.device.inputs().bump_left = true;
  robot.to_tick();
  robot.device.inputs().bump_left = false;
  // It stands before it backs off.
  for (int i = 0; i < 60 && robot.device.commanded().left_mm_s >= 0.0; ++i) robot.to_tick();
  EXPECT_LT(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_LT(robot.device.commanded().right_mm_s, 0.0);
  robot.wait(2s);
  EXPECT_LT(robot.device.truth().pose.heading_rad, -0.5) << "and to the other side";
}

TEST(DemosOfTheManual, TagTurnsAroundWhereItBumps) {  // OI p. 8
  DemoRobot robot{7};
  // In sight for a second of its turn: it drives there.
  robot.device.inputs().virtual_wall = true;
  robot.wait(1s);
  robot.device.inputs().virtual_wall = false;
  robot.wait(1s);
  EXPECT_GT(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_GT(robot.device.commanded().right_mm_s, 0.0);
  robot.device.inputs().bump_left = true;
  robot.device.inputs().bump_right = true;
  robot.to_tick();
  const double before = robot.device.truth().pose.heading_rad;
  robot.device.inputs() = {};
  robot.wait(8s);
  EXPECT_TRUE(robot.device.demos().running());
  EXPECT_GT(std::abs(robot.device.truth().pose.heading_rad - before), 3.0);
}

// The four cliff sensors in turn, from left to right.
std::array<int, 4> chord(bool bump_left, bool bump_right) {
  DemoRobot robot{9};
  robot.device.inputs().bump_left = bump_left;
  robot.device.inputs().bump_right = bump_right;
  std::array<int, 4> notes{};
  std::size_t i = 0;
  for (CliffSensor Inputs::* sensor : {&Inputs::cliff_left, &Inputs::cliff_front_left,
                                       &Inputs::cliff_front_right, &Inputs::cliff_right}) {
    (robot.device.inputs().*sensor).cliff = true;
    robot.to_tick();
    notes.at(i++) = robot.device.sounding();
    (robot.device.inputs().*sensor).cliff = false;
  }
  return notes;
}

std::set<int> pitches(const std::array<int, 4>& notes) {
  std::set<int> pitches;
  for (const int note : notes) pitches.insert(note % 12);
  return pitches;
}

TEST(DemosOfTheManual, BanjoHasANoteForEachCliffSensor) {  // OI p. 8
  for (const auto& [left, right] :
       {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    const std::array<int, 4> notes = chord(left, right);
    EXPECT_EQ(std::set<int>(notes.begin(), notes.end()).size(), 4U);
    EXPECT_GE(*std::min_element(notes.begin(), notes.end()), 31);
  }
}

TEST(DemosOfTheManual, BanjoPlaysGMajorDMajor7AndCMajor) {  // OI p. 8
  EXPECT_EQ(pitches(chord(false, false)), (std::set<int>{7, 11, 2})) << "G, B, D";
  for (const auto& [left, right] : {std::pair{true, false}, {false, true}}) {
    EXPECT_EQ(pitches(chord(left, right)), (std::set<int>{2, 6, 9, 1})) << "D, F#, A, C#";
  }
  EXPECT_EQ(pitches(chord(true, true)), (std::set<int>{0, 4, 7})) << "C, E, G";
}

TEST(Charge, FallsInUseAndRisesOnACharger) {  // OI p. 19
  Robot robot;
  robot.send({128, 132, 145, 1, 244, 1, 244});
  const auto charge = [&robot] {
    robot.device.inputs().charger = false;
    robot.wait(100ms);
    (void)robot.receive();
    return word(robot.ask({142, 25}), 0);
  };
  const std::int16_t full = charge();
  robot.wait(360s);
  const std::int16_t used = charge();
  EXPECT_LT(used, full);
  robot.send({128});
  robot.device.inputs().charger = true;
  robot.wait(360s);
  EXPECT_GT(charge(), used);
}

TEST(Current, IsNegativeInUseAndPositiveOnACharger) {  // OI p. 19
  Parameters quiet;
  quiet.charging_text = false;
  Robot robot{quiet};
  robot.send({128});
  robot.to_tick();
  EXPECT_LT(word(robot.ask({142, 23}), 0), 0);
  robot.device.inputs().charger = true;
  robot.wait(1s);
  EXPECT_GT(word(robot.ask({142, 23}), 0), 0);
}

TEST(SensorsOfTheManual, PutEachDigitalInputInItsBit) {  // OI p. 20
  for (std::size_t input = 0; input < 4; ++input) {
    Robot robot;
    robot.send({128});
    robot.device.inputs().digital.at(input) = true;
    robot.to_tick();
    EXPECT_EQ(robot.ask({142, 32}), (Bytes{static_cast<std::uint8_t>(0b10000 | 1U << input)}));
  }
}

TEST(SensorsOfTheManual, SendEachSignalHighByteFirst) {  // OI p. 19, 20
  Robot robot;
  robot.send({128});
  Inputs& inputs = robot.device.inputs();
  inputs.wall_signal = 0x0102;
  inputs.cliff_left.signal = 0x0304;
  inputs.cliff_front_left.signal = 0x0506;
  inputs.cliff_front_right.signal = 0x0708;
  inputs.cliff_right.signal = 0x0f0a;
  inputs.analog = 0x0201;
  robot.to_tick();
  EXPECT_EQ(robot.ask({149, 6, 27, 28, 29, 30, 31, 33}),
            (Bytes{1, 2, 3, 4, 5, 6, 7, 8, 15, 10, 2, 1}));
}

TEST(SensorsOfTheManual, CapTheAngleAtItsEnds) {  // OI p. 19
  Odometer odometer{Parameters{}};
  odometer.latch(-2'000'000, 2'000'000);
  EXPECT_EQ(odometer.take_angle().value, 32767);
  odometer.latch(2'000'000, -2'000'000);
  EXPECT_EQ(odometer.take_angle().value, -32768);
}

TEST(SensorsOfTheManual, AverageTheWheelsForTheDistance) {  // OI p. 18
  Robot robot{ideal_wheels()};
  robot.send({128, 132, 145, 0, 200, 0, 100});
  robot.wait(3s);
  robot.send({145, 0, 0, 0, 0});
  robot.to_tick();
  EXPECT_NEAR(word(robot.ask({142, 19}), 0), 450, 4);
}

}  // namespace
}  // namespace cargobay::hal::sim
