// OI p. 6 and 7: what each mode obeys and what changes it.
#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers
using oi::Mode;

TEST(Modes, BeginOff) { EXPECT_EQ(Robot{}.device.mode(), Mode::off); }

TEST(Modes, OffHearsOnlyStart) {
  Robot robot;
  for (int opcode = 0; opcode < 256; ++opcode) {
    if (opcode != 128) robot.send({static_cast<std::uint8_t>(opcode)});
  }
  EXPECT_EQ(robot.device.mode(), Mode::off);
  EXPECT_TRUE(robot.receive().empty());
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1})) << "nothing was half-sent while it was off";
}

TEST(Modes, ChangeByTheirCommands) {
  Robot robot;
  robot.send({128});
  robot.send({131});
  EXPECT_EQ(robot.device.mode(), Mode::safe);
  robot.send({132});
  EXPECT_EQ(robot.device.mode(), Mode::full);
  robot.send({130});
  EXPECT_EQ(robot.device.mode(), Mode::safe) << "Control is Safe";
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), Mode::passive);
}

TEST(Modes, BecomePassiveWithADemo) {
  for (const std::uint8_t opcode : Bytes{134, 135, 143}) {
    Robot robot;
    robot.send({128, 132, opcode});
    EXPECT_EQ(robot.device.mode(), Mode::passive) << int{opcode};
  }
  Robot robot;
  robot.send({128, 132, 136, 255});
  EXPECT_EQ(robot.device.mode(), Mode::passive);
}

TEST(Modes, PassiveRefusesEveryActuator) {
  Robot robot;
  robot.send({128});
  robot.send({137, 0,   100, 128, 0,   145, 0,   100, 0,   100, 139, 10, 255, 255, 138, 7,
              144, 128, 128, 128, 147, 7,   151, 9,   140, 0,   1,   60, 64,  141, 0});
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_FALSE(robot.device.actuators().lit(oi::Led::play));
  EXPECT_EQ(robot.device.actuators().low_side_drivers[2], 0);
  EXPECT_EQ(robot.device.actuators().infrared_count, 0U);
  EXPECT_FALSE(robot.device.songs().playing());
  EXPECT_EQ(robot.device.counters().commands_refused, 8U) << "all but Song, which is not one";
}

TEST(Modes, PassiveAnswersSensors) {
  Robot robot;
  robot.send({128});
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Modes, TurnTheLedsOffWhenSafeBegins) {
  Robot robot;
  robot.send({128, 132, 139, 10, 255, 128});
  EXPECT_TRUE(robot.device.actuators().lit(oi::Led::advance));
  robot.send({131});
  EXPECT_FALSE(robot.device.actuators().lit(oi::Led::advance));
  EXPECT_EQ(robot.device.actuators().leds.power_intensity, 0);
}

TEST(Modes, StopTheMotorsWhenPassiveBegins) {
  Robot robot;
  robot.send({128, 132, 145, 0, 100, 0, 100, 138, 7});
  EXPECT_EQ(robot.device.commanded().left_mm_s, 100.0);
  robot.send({128});
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
  EXPECT_EQ(robot.device.actuators().low_side_drivers[0], 0);
  robot.wait(2s);
  EXPECT_EQ(robot.device.truth().speeds.left_mm_s, 0.0);
}

TEST(Modes, KeepDrivingBetweenSafeAndFull) {
  Robot robot;
  robot.send({128, 131, 145, 0, 100, 0, 100, 132});
  EXPECT_EQ(robot.device.commanded().right_mm_s, 100.0);
}

TEST(Modes, WaitForTheBytesOfAHalfSentCommand) {
  Robot robot;
  robot.send({128, 132, 145, 0});
  robot.wait(5s);
  robot.send({128, 131, 142});  // its data, whatever they would mean elsewhere
  EXPECT_EQ(robot.device.mode(), Mode::full);
  EXPECT_EQ(robot.device.commanded().right_mm_s, 128.0);
  EXPECT_EQ(robot.device.commanded().left_mm_s, -500.0) << "131 142 is -31858, which it cannot do";
  robot.send({131});
  EXPECT_EQ(robot.device.mode(), Mode::safe);
}

TEST(Modes, IgnoreUnknownOpcodes) {
  Robot robot;
  robot.send({128, 173, 0, 127, 255, 7, 132});
  EXPECT_EQ(robot.device.mode(), Mode::full);
  EXPECT_EQ(robot.device.counters().unknown_opcodes, 5U);
}

TEST(Modes, AreFreedFromAnyHalfSentCommandByStarts) {
  // The longest command that the parser can wait for is a song of 255 notes.
  Robot robot;
  robot.send({128, 132, 140, 0, 255});
  robot.send(Bytes(510, 128));
  robot.send({131});
  EXPECT_EQ(robot.device.mode(), Mode::safe);
}

// It listens for Start, and does not assemble commands to find it.
TEST(Modes, OffFindsStartInTheDataOfACommand) {
  Robot robot;
  robot.send({137, 0, 100, 128});
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Modes, BeepOnceWhenTheyAreLeavingOff) {
  Robot robot;
  robot.send({128});
  EXPECT_NE(robot.device.sounding(), 0);
  EXPECT_EQ(robot.ask({142, 37}), (Bytes{0})) << "it is no song";
  robot.wait(200ms);
  EXPECT_EQ(robot.device.sounding(), 0);
  robot.send({128});
  EXPECT_EQ(robot.device.sounding(), 0) << "from Passive";
}

TEST(Modes, TurnTheLedsOffWhenFullBegins) {
  for (const std::uint8_t before : Bytes{128, 131, 132}) {
    Robot robot;
    robot.send({128, 132, 139, 10, 255, 128, before, 132});
    EXPECT_FALSE(robot.device.actuators().lit(oi::Led::advance)) << int{before};
    EXPECT_EQ(robot.device.actuators().leds.power_intensity, 0) << int{before};
  }
}

// "You cannot change" them to something else (OI p. 6): everything except motion goes on as it is.
void expect_what_passive_leaves(const Robot& robot) {
  EXPECT_EQ(robot.device.mode(), Mode::passive);
  EXPECT_EQ(robot.device.commanded(), WheelSpeeds{});
  EXPECT_EQ(robot.device.actuators().low_side_drivers, (std::array<std::uint8_t, 3>{}));
  EXPECT_EQ(robot.device.actuators().digital_outputs, 0b101);
  EXPECT_TRUE(robot.device.actuators().lit(oi::Led::play));
  EXPECT_TRUE(robot.device.songs().playing());
}

TEST(Modes, LeaveOutputsLedsAndSongsAloneWhenPassiveBegins) {
  for (const Bytes& to_passive : {Bytes{128}, Bytes{136, 255}, Bytes{136, 10}, Bytes{}}) {
    Robot robot;
    robot.send(
        {128, 131, 139, 2, 0, 0, 147, 5, 138, 7, 140, 0, 1, 60, 255, 141, 0, 145, 0, 100, 0, 100});
    if (to_passive.empty()) robot.device.inputs().wheel_drop_left = true;  // a hazard
    robot.send(to_passive);
    robot.to_tick();
    expect_what_passive_leaves(robot);
  }
}

// If the robot has a sensible nearest value it uses that; otherwise it does nothing.
TEST(Modes, CountWhatIsOutOfRange) {
  struct Case {
    Bytes command;
    bool counted;
  };
  for (const auto& [command, counted] :
       {Case{{137, 1, 245, 0, 100}, true}, Case{{137, 1, 244, 7, 209}, true},
        Case{{137, 1, 244, 7, 208}, false}, Case{{137, 1, 244, 127, 255}, false},
        Case{{145, 1, 245, 0, 0}, true}, Case{{139, 1, 0, 0}, true}, Case{{147, 8}, true},
        Case{{138, 8}, true}, Case{{144, 129, 0, 0}, true}, Case{{129, 12}, true},
        Case{{150, 2}, true}, Case{{141, 16}, true}, Case{{158, 23}, true}, Case{{136, 10}, true},
        Case{{136, 255}, false}, Case{{139, 10, 255, 255}, false}}) {
    Robot robot;
    robot.send({128, 132});
    robot.send(command);
    EXPECT_EQ(robot.device.counters().commands_out_of_range, counted ? 1U : 0U)
        << int{command[0]} << " " << int{command[1]};
  }
}

TEST(Modes, ResumeAStreamByAnythingButNought) {
  Robot robot;
  robot.send({128, 148, 1, 35, 150, 0});
  EXPECT_FALSE(robot.device.stream().running());
  robot.send({150, 2});
  EXPECT_TRUE(robot.device.stream().running());
}

}  // namespace
}  // namespace cargobay::hal::sim
