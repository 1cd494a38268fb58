// OI p. 9 to 12: LEDs, outputs, drivers, infrared, songs; p. 15: scripts as they are stored.
#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct InSafe : Robot {
  InSafe() { send({128, 132}); }
};

TEST(Leds, ShowTheManualsExample) {
  InSafe robot;
  robot.send({139, 8, 0, 128});
  EXPECT_FALSE(robot.device.actuators().lit(oi::Led::play));
  EXPECT_TRUE(robot.device.actuators().lit(oi::Led::advance));
  EXPECT_EQ(robot.device.actuators().leds.power_color, 0);
  EXPECT_EQ(robot.device.actuators().leds.power_intensity, 128);
}

TEST(LowSideDrivers, SwitchFullyOn) {
  InSafe robot;
  robot.send({138, 2});
  EXPECT_EQ(robot.device.actuators().low_side_drivers, (std::array<std::uint8_t, 3>{0, 128, 0}));
}

TEST(LowSideDrivers, TakeTheDutyOfDriver2First) {
  InSafe robot;
  robot.send({144, 32, 0, 128});  // the manual's example
  EXPECT_EQ(robot.device.actuators().low_side_drivers, (std::array<std::uint8_t, 3>{128, 0, 32}));
  robot.send({144, 255, 129, 128});
  EXPECT_EQ(robot.device.actuators().low_side_drivers,
            (std::array<std::uint8_t, 3>{128, 128, 128}));
}

TEST(DigitalOutputs, AreThree) {
  InSafe robot;
  robot.send({147, 0xfd});
  EXPECT_EQ(robot.device.actuators().digital_outputs, 0b101);
}

TEST(SendIr, SendsItsByte) {
  InSafe robot;
  robot.send({151, 0});
  EXPECT_EQ(robot.device.actuators().infrared_sent, 0);
  EXPECT_EQ(robot.device.actuators().infrared_count, 1U);
}

TEST(Songs, LastAsLongAsTheirNotes) {
  InSafe robot;
  robot.send({140, 3, 2, 60, 32, 30, 16, 141, 3});  // half a second, then a rest of a quarter
  EXPECT_EQ(robot.ask({149, 2, 36, 37}), (Bytes{3, 1}));
  EXPECT_EQ(robot.device.songs().sounding(robot.device.now()), 60);
  robot.wait(600ms);
  EXPECT_EQ(robot.device.songs().sounding(robot.device.now()), 0);
  EXPECT_EQ(robot.ask({142, 37}), (Bytes{1}));
  robot.wait(150ms);
  EXPECT_EQ(robot.ask({149, 2, 36, 37}), (Bytes{3, 0}));
}

TEST(Songs, IgnorePlayWhileOnePlays) {
  InSafe robot;
  robot.send({140, 0, 1, 60, 64, 140, 1, 1, 61, 64, 141, 0, 141, 1});
  EXPECT_EQ(robot.device.songs().selected(), 0);
  robot.wait(1100ms);
  robot.send({141, 1});
  EXPECT_EQ(robot.device.songs().selected(), 1);
}

// The robot has a copy of what it plays: the new song is for the next time.
TEST(Songs, PlayOnAsTheyBeganWhenTheirNumberIsGivenAway) {
  InSafe robot;
  robot.send({140, 0, 2, 60, 32, 62, 32, 141, 0});  // two notes of half a second
  robot.wait(250ms);
  robot.send({140, 0, 1, 72, 8});
  EXPECT_EQ(robot.device.sounding(), 60);
  robot.wait(500ms);
  EXPECT_EQ(robot.device.sounding(), 62);
  EXPECT_EQ(robot.ask({142, 37}), (Bytes{1})) << "the new one would be over";
  robot.wait(500ms);
  EXPECT_EQ(robot.ask({142, 37}), (Bytes{0}));
  robot.send({141, 0});
  EXPECT_EQ(robot.device.sounding(), 72);
}

TEST(Songs, KeepTheOldOneInsteadOfOneTooLong) {
  InSafe robot;
  robot.send({140, 0, 1, 60, 32});
  Bytes longer{140, 0, 17};
  for (int i = 0; i < 17; ++i) longer.insert(longer.end(), {72, 1});
  robot.send(longer);
  robot.send({140, 0, 0, 140, 16, 1, 72, 32, 141, 0});
  EXPECT_EQ(robot.device.sounding(), 60);
  EXPECT_EQ(robot.device.counters().commands_out_of_range, 3U)
      << "seventeen notes, none, a seventeenth song";
}

TEST(Songs, IgnoreASlotWithNothingInIt) {
  InSafe robot;
  robot.send({141, 5, 141, 16, 141, 255});
  EXPECT_FALSE(robot.device.songs().playing());
}

TEST(Songs, HoldAllSixteenOfSixteenNotes) {
  InSafe robot;
  for (std::uint8_t slot = 0; slot < 16; ++slot) {
    Bytes song{140, slot, 16};
    for (std::uint8_t note = 0; note < 16; ++note) song.insert(song.end(), {60, 1});
    robot.send(song);
    robot.send({141, slot});
    EXPECT_EQ(robot.device.songs().selected(), slot);
    robot.wait(300ms);
  }
}

TEST(Script, IsShownAsItWasStored) {
  InSafe robot;
  robot.send({152, 13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0});
  EXPECT_EQ(robot.ask({154}), (Bytes{13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0}));
  robot.send({152, 0});
  EXPECT_EQ(robot.ask({154}), (Bytes{0}));
}

TEST(Script, HaltsTheStreamWhenShown) {
  InSafe robot;
  robot.send({148, 1, 35, 154});
  robot.wait(100ms);
  EXPECT_EQ(robot.receive(), (Bytes{0}));
  robot.send({150, 1});
  robot.wait(100ms);
  EXPECT_FALSE(robot.receive().empty());
}

}  // namespace
}  // namespace cargobay::hal::sim
