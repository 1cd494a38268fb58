// OI p. 15 and 16: scripts, and the Wait commands they are made for.
#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Scripted : Robot {
  explicit Scripted(const Parameters& parameters = ideal_wheels()) : Robot{parameters} {
    send({128, 132});
  }
};

TEST(Script, DrivesTheManualsFortyCentimetres) {
  Scripted robot;
  robot.send({152, 13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0});
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0) << "stored, not played";
  robot.send({153});
  EXPECT_EQ(robot.device.commanded().left_mm_s, 300.0);
  robot.wait(2s);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_NEAR(robot.device.truth().pose.x_mm, 400.0, 300.0 * 0.0151);
}

TEST(Script, TogglesTheManualsLedOnBumps) {
  Scripted robot;
  robot.send({152, 17, 158, 5, 158, 251, 139, 2, 0, 0, 158, 5, 158, 251, 139, 0, 0, 0, 153});
  robot.send({153});
  for (const bool lit : {true, false, true, false, true}) {
    EXPECT_NE(robot.device.actuators().lit(oi::Led::play), lit);
    robot.device.inputs().bump_left = true;
    robot.wait(100ms);
    EXPECT_NE(robot.device.actuators().lit(oi::Led::play), lit) << "not before the bump is over";
    robot.device.inputs().bump_left = false;
    robot.wait(100ms);
    EXPECT_EQ(robot.device.actuators().lit(oi::Led::play), lit);
  }
}

TEST(Script, DrivesTheManualsSquareForEver) {
  Scripted robot;
  robot.send({152, 17, 137, 1, 44, 128, 0, 156, 1, 144, 137, 1, 44, 0, 1, 157, 0, 90, 153});
  robot.send({153});
  double farthest_mm = 0.0;
  for (int i = 0; i < 1000; ++i) {
    robot.to_tick();
    const WorldPose pose = robot.device.truth().pose;
    farthest_mm = std::max({farthest_mm, std::abs(pose.x_mm), std::abs(pose.y_mm)});
  }
  EXPECT_NEAR(farthest_mm, 400.0, 60.0);
  EXPECT_GT(robot.device.truth().pose.heading_rad, 3.0 * 1.57);
}

TEST(Script, GoesOnLoopingWithoutAWaitAndStaysResponsive) {
  Scripted robot;
  robot.send({152, 5, 139, 10, 0, 0, 153, 153});
  robot.wait(1s);
  EXPECT_TRUE(robot.device.actuators().lit(oi::Led::advance));
  robot.send({142, 35});
  robot.wait(50ms);
  EXPECT_EQ(robot.receive(), (Bytes{3}));
}

TEST(Script, PlaysNothingWhereNoneIsStored) {
  Scripted robot;
  robot.send({153});
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{3}));
  robot.send({152, 2, 142, 35, 152, 0, 153});
  robot.wait(50ms);
  EXPECT_TRUE(robot.receive().empty());
}

TEST(Script, IgnoresOneOfMoreThanAHundredBytes) {
  Scripted robot;
  Bytes longest{152, 100};
  longest.resize(102, 173);
  robot.send(longest);
  EXPECT_EQ(robot.device.script().size(), 100U);
  Bytes longer{152, 101};
  longer.resize(103, 128);
  robot.send(longer);
  EXPECT_EQ(robot.device.script().size(), 100U);
  EXPECT_EQ(robot.device.script()[99], 173) << "the one before";
  EXPECT_EQ(robot.device.counters().commands_out_of_range, 1U);
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{3})) << "all its bytes were taken";
}

TEST(Wait, IsDeafAndKeepsWhatItHearsForLater) {
  Scripted robot;
  // What hosts do: drive, wait, stop, and ask for the script as a sign that it is done.
  robot.send({137, 0, 200, 128, 0, 156, 0, 100, 137, 0, 0, 0, 0, 154});
  robot.wait(400ms);
  EXPECT_TRUE(robot.device.waiting());
  EXPECT_TRUE(robot.receive().empty());
  robot.send({142, 35});
  robot.wait(50ms);
  EXPECT_TRUE(robot.receive().empty());
  robot.wait(200ms);
  EXPECT_EQ(robot.receive(), (Bytes{0, 3}));
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
}

// "Nor does it react to any inputs" (OI p. 15): not even to the button that it waits for.
TEST(Wait, StartsNoDemoByTheButtonItWaitsFor) {
  Robot robot;
  robot.send({128, 158, 17});
  robot.device.press(oi::Button::play, 200ms);
  robot.to_tick();
  robot.to_tick();
  EXPECT_FALSE(robot.device.waiting());
  EXPECT_FALSE(robot.device.demos().running());
}

// The host refuses to send one; to the robot it is a command like any other.
TEST(Script, MayHoldAScript) {
  Scripted robot;
  robot.send({152, 6, 152, 2, 142, 35, 142, 35, 153});
  robot.wait(50ms);
  EXPECT_EQ(robot.receive(), (Bytes{3})) << "what follows the script within is played";
  EXPECT_EQ(robot.ask({154}), (Bytes{2, 142, 35}));
}

TEST(Wait, LosesWhatItHasNoRoomFor) {
  Scripted robot;
  robot.send({155, 255});
  robot.send(Bytes(2000, 0));
  EXPECT_GT(robot.device.counters().bytes_overrun, 1000U);
  robot.wait(26s);
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{3}));
}

TEST(Wait, SilencesTheStream) {
  Scripted robot;
  robot.send({148, 1, 35, 155, 10});
  robot.wait(900ms);
  EXPECT_TRUE(robot.receive().empty());
  robot.wait(300ms);
  EXPECT_FALSE(robot.receive().empty());
}

TEST(Wait, LastsTenthsOfSecondsByTicks) {
  Scripted robot;
  robot.to_tick();
  const rt::Duration before = robot.device.now();
  robot.send({155, 10});
  while (robot.device.waiting()) robot.to_tick();
  const rt::Duration waited = robot.device.now() - before;
  EXPECT_GE(waited, 1s);
  EXPECT_LE(waited, 1016ms);
}

TEST(Wait, CountsDistanceBackward) {
  Scripted robot;
  robot.send({145, 0xff, 0x38, 0xff, 0x38, 156, 0xff, 0x9c});  // -200 mm/s, -100 mm
  robot.wait(450ms);
  EXPECT_TRUE(robot.device.waiting());
  robot.wait(100ms);
  EXPECT_FALSE(robot.device.waiting());
}

TEST(Wait, CountsAnglesBothWays) {
  Scripted robot;
  robot.send(
      {137, 0, 129, 0xff, 0xff, 157, 0xff, 0xa6});  // clockwise a radian a second, -90 degrees
  robot.wait(1500ms);
  EXPECT_TRUE(robot.device.waiting());
  robot.wait(120ms);
  EXPECT_FALSE(robot.device.waiting());
}

// Whichever way the robot goes: a 0 that is only reached going forward would never end.
TEST(Wait, EndsAtOnceForNoDistanceNoAngleAndNoTime) {
  for (const Bytes& drive :
       {Bytes{145, 0xff, 0x38, 0xff, 0x38}, Bytes{145, 0, 200, 0, 200}, Bytes{145, 0, 0, 0, 0},
        Bytes{137, 0, 129, 0xff, 0xff}, Bytes{137, 0, 129, 0, 1}}) {
    for (const Bytes& none : {Bytes{156, 0, 0}, Bytes{157, 0, 0}, Bytes{155, 0}}) {
      Scripted robot;
      robot.send(drive);
      robot.wait(500ms);
      robot.send(none);
      EXPECT_FALSE(robot.device.waiting()) << int{drive[2]} << ", opcode " << int{none[0]};
    }
  }
}

TEST(Wait, BeginsCountingAnewEachTime) {
  Scripted robot;
  robot.send({145, 0, 200, 0, 200});
  robot.wait(2s);
  robot.send({156, 0, 100});
  robot.wait(450ms);
  EXPECT_TRUE(robot.device.waiting());
}

// Each event, and its inverse.
struct EventCase {
  std::int8_t event;
  void (*set)(Inputs&);
};
constexpr EventCase kEvents[] = {
    {1, [](Inputs& in) { in.wheel_drop_caster = true; }},
    {2, [](Inputs& in) { in.wheel_drop_caster = true; }},
    {3, [](Inputs& in) { in.wheel_drop_left = true; }},
    {4, [](Inputs& in) { in.wheel_drop_right = true; }},
    {5, [](Inputs& in) { in.bump_right = true; }},
    {6, [](Inputs& in) { in.bump_left = true; }},
    {7, [](Inputs& in) { in.bump_right = true; }},
    {8, [](Inputs& in) { in.virtual_wall = true; }},
    {9, [](Inputs& in) { in.wall = true; }},
    {10, [](Inputs& in) { in.cliff_right.cliff = true; }},
    {11, [](Inputs& in) { in.cliff_left.cliff = true; }},
    {12, [](Inputs& in) { in.cliff_front_left.cliff = true; }},
    {13, [](Inputs& in) { in.cliff_front_right.cliff = true; }},
    {14, [](Inputs& in) { in.cliff_right.cliff = true; }},
    {15, [](Inputs& in) { in.home_base = true; }},
    {16, [](Inputs& in) { in.advance_button = true; }},
    {17, [](Inputs& in) { in.play_button = true; }},
    {18, [](Inputs& in) { in.digital[0] = true; }},
    {19, [](Inputs& in) { in.digital[1] = true; }},
    {20, [](Inputs& in) { in.digital[2] = true; }},
    {21, [](Inputs& in) { in.digital[3] = true; }},
};

TEST(Wait, EndsWithItsEvent) {
  for (const EventCase& each : kEvents) {
    Scripted robot;
    robot.send({158, static_cast<std::uint8_t>(each.event)});
    robot.wait(100ms);
    EXPECT_TRUE(robot.device.waiting()) << int{each.event};
    each.set(robot.device.inputs());
    robot.to_tick();
    EXPECT_FALSE(robot.device.waiting()) << int{each.event};
  }
}

TEST(Wait, EndsWhenItsEventIsOver) {
  for (const EventCase& each : kEvents) {
    Scripted robot;
    each.set(robot.device.inputs());
    robot.to_tick();
    robot.send({158, static_cast<std::uint8_t>(-each.event)});
    robot.wait(100ms);
    EXPECT_TRUE(robot.device.waiting()) << int{each.event};
    robot.device.inputs() = {};
    robot.to_tick();
    EXPECT_FALSE(robot.device.waiting()) << int{each.event};
  }
}

TEST(Wait, SeesTheModeBecomePassive) {
  Robot robot;
  robot.send({128, 131, 158, 22});
  robot.wait(100ms);
  EXPECT_TRUE(robot.device.waiting());
  robot.device.inputs().wheel_drop_left = true;
  robot.to_tick();
  EXPECT_FALSE(robot.device.waiting());
}

TEST(Wait, DoesNotWaitForAnEventThatIsNone) {
  for (const std::uint8_t event : Bytes{0, 23, 233, 128}) {
    Scripted robot;
    robot.send({158, event});
    EXPECT_FALSE(robot.device.waiting()) << int{event};
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
