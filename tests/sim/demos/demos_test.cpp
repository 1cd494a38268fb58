// OI p. 8: the demos, as far as they are simple behaviours.
#include "hal/sim/demos/demos.hpp"

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Demonstrating : Robot {
  explicit Demonstrating(std::uint8_t number) : Robot{ideal_wheels()} {
    send({128, 136, number});
    wait(200ms);
  }
  bool moves() const {
    const WheelSpeeds speeds = device.commanded();
    return speeds.left_mm_s != 0.0 || speeds.right_mm_s != 0.0;
  }
};

TEST(Demos, RunInPassiveModeUntilAborted) {
  for (const std::uint8_t number : Bytes{0, 1, 2, 3, 4, 6, 7}) {
    Demonstrating robot{number};
    EXPECT_TRUE(robot.device.demos().running()) << int{number};
    EXPECT_TRUE(robot.moves()) << int{number};
    EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
    robot.send({136, 255});
    EXPECT_FALSE(robot.moves()) << int{number};
    EXPECT_FALSE(robot.device.demos().running());
  }
}

TEST(Demos, HaveOpcodesOfTheirOwn) {
  const auto started = [](std::uint8_t opcode) {
    Robot robot;
    robot.send({128, 132, opcode});
    return robot.device.demos().number();
  };
  EXPECT_EQ(started(134), oi::DemoNumber::spot_cover);
  EXPECT_EQ(started(135), oi::DemoNumber::cover);
  EXPECT_EQ(started(143), oi::DemoNumber::cover_and_dock);
}

TEST(Demos, EndWithAModeCommand) {
  for (const std::uint8_t opcode : Bytes{128, 131, 132}) {
    Demonstrating robot{0};
    robot.send({opcode});
    EXPECT_FALSE(robot.moves());
    robot.wait(1s);
    EXPECT_FALSE(robot.moves());
  }
}

TEST(Demos, IgnoreANumberThatIsNone) {
  Demonstrating robot{10};
  EXPECT_FALSE(robot.device.demos().running());
}

TEST(Demos, StopWhenLifted) {
  for (std::uint8_t number = 0; number < 10; ++number) {
    Demonstrating robot{number};
    robot.device.inputs().wheel_drop_left = true;
    robot.wait(100ms);
    EXPECT_FALSE(robot.moves()) << int{number};
    EXPECT_FALSE(robot.device.demos().running()) << int{number};
  }
}

TEST(Demos, CoverTurnsAwayFromWhatItMeets) {
  Demonstrating robot{0};
  robot.device.inputs().bump_left = true;
  robot.to_tick();
  robot.device.inputs().bump_left = false;
  // It stands before it backs off.
  for (int i = 0; i < 60 && robot.device.commanded().left_mm_s >= 0.0; ++i) robot.to_tick();
  EXPECT_LT(robot.device.commanded().left_mm_s, 0.0);
  const double heading = robot.device.truth().pose.heading_rad;
  robot.wait(5s);
  EXPECT_LT(robot.device.truth().pose.heading_rad, heading - 0.5) << "to the right";
  EXPECT_GT(robot.device.commanded().left_mm_s, 0.0) << "and on";
}

TEST(Demos, CoverAndDockEndsOnTheHomeBase) {
  Demonstrating robot{1};
  const auto turns_left = [&robot](std::uint8_t infrared) {
    robot.device.inputs().infrared = infrared;
    robot.to_tick();
    return robot.device.commanded().left_mm_s < robot.device.commanded().right_mm_s;
  };
  EXPECT_TRUE(turns_left(248)) << "red alone";
  EXPECT_FALSE(turns_left(252)) << "the middle, from red";
  EXPECT_FALSE(turns_left(244)) << "green alone";
  EXPECT_TRUE(turns_left(252)) << "the middle, from green";
  robot.device.inputs().home_base = true;
  robot.to_tick();
  EXPECT_FALSE(robot.moves());
}

// It may coast past the contacts.
TEST(Demos, CoverAndDockGoesOnIfItTouchedTheBaseOnlyInPassing) {
  Demonstrating robot{1};
  robot.device.inputs().home_base = true;
  robot.wait(300ms);
  EXPECT_FALSE(robot.moves());
  EXPECT_TRUE(robot.device.demos().running());
  robot.device.inputs().home_base = false;
  robot.wait(300ms);
  EXPECT_TRUE(robot.moves());
  robot.device.inputs().home_base = true;
  robot.wait(600ms);
  EXPECT_FALSE(robot.device.demos().running());
}

TEST(Demos, SpotComesBackToWhereItBegan) {
  Demonstrating robot{2};
  robot.wait(61s);
  EXPECT_FALSE(robot.device.demos().running());
}

TEST(Demos, FigureEightTurnsBothWays) {
  Demonstrating robot{4};
  double left_most = 0.0;
  double right_most = 0.0;
  for (int i = 0; i < 2000; ++i) {
    robot.to_tick();
    left_most = std::max(left_most, robot.device.truth().pose.y_mm);
    right_most = std::min(right_most, robot.device.truth().pose.y_mm);
  }
  EXPECT_GT(left_most, 200.0);
  EXPECT_LT(right_most, -200.0);
}

TEST(Demos, HomeTurnsUntilItSeesAVirtualWall) {
  Demonstrating robot{6};
  EXPECT_LT(robot.device.commanded().left_mm_s, 0.0);
  const auto turned_rad = [&robot] { return robot.device.truth().pose.heading_rad; };
  const double came_rad = turned_rad();
  robot.device.inputs().virtual_wall = true;
  robot.wait(1s);
  EXPECT_LT(robot.device.commanded().left_mm_s, 0.0) << "on, until it is out of sight again";
  const double left_rad = turned_rad();
  robot.device.inputs().virtual_wall = false;
  robot.wait(1s);
  EXPECT_GT(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_NEAR(turned_rad(), 0.5 * (came_rad + left_rad), 0.1) << "in the middle between the two";
  robot.device.inputs().bump_right = true;
  robot.to_tick();
  EXPECT_FALSE(robot.device.demos().running());
}

TEST(Demos, HomeDrivesOnAsItStandsWithoutTheTape) {
  Demonstrating robot{6};
  robot.device.inputs().virtual_wall = true;
  robot.wait(20s);
  EXPECT_GT(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_NEAR(robot.device.commanded().left_mm_s, robot.device.commanded().right_mm_s, 5.0);
}

TEST(Demos, PachelbelPlaysANoteACliff) {
  Demonstrating robot{8};
  EXPECT_EQ(robot.device.sounding(), 0);
  robot.device.inputs().cliff_left.cliff = true;
  robot.to_tick();
  const std::uint8_t first = robot.device.sounding();
  EXPECT_NE(first, 0);
  robot.device.inputs().cliff_left.cliff = false;
  robot.to_tick();
  EXPECT_EQ(robot.device.sounding(), 0);
  robot.device.inputs().cliff_right.cliff = true;
  robot.to_tick();
  EXPECT_NE(robot.device.sounding(), first);
}

// The first voice of the canon: F# E D C# B A B C#, and again.
TEST(Demos, PachelbelPlaysTheCanonInItsOrder) {
  Demonstrating robot{8};
  for (const int note : {78, 76, 74, 73, 71, 69, 71, 73, 78}) {
    robot.device.inputs().cliff_front_right.cliff = true;
    robot.to_tick();
    EXPECT_EQ(robot.device.sounding(), note);
    robot.device.inputs().cliff_front_right.cliff = false;
    robot.to_tick();
  }
}

TEST(Buttons, StartAndEndTheDemoSelected) {
  Robot robot;
  robot.send({128});
  const auto press = [&](bool Inputs::* button) {
    robot.device.inputs().*button = true;
    robot.to_tick();
    robot.device.inputs().*button = false;
    robot.to_tick();
  };
  press(&Inputs::advance_button);
  press(&Inputs::advance_button);
  press(&Inputs::play_button);
  EXPECT_TRUE(robot.device.demos().running());
  EXPECT_EQ(robot.device.demos().number(), oi::DemoNumber::spot_cover);
  press(&Inputs::play_button);
  EXPECT_FALSE(robot.device.demos().running());
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
}

TEST(Buttons, DoNothingInSafeAndFull) {
  for (const std::uint8_t mode : Bytes{131, 132}) {
    Robot robot;
    robot.send({128, mode});
    robot.device.inputs().play_button = true;
    robot.wait(100ms);
    EXPECT_FALSE(robot.device.demos().running());
    EXPECT_EQ(robot.ask({142, 18}), (Bytes{1}));
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
