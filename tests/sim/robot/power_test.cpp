// OI p. 4 and 5: power, boot, the Baud Rate Change pin; and what the robot prints besides its
// packets.
#include <string>

#include <gtest/gtest.h>

#include "hal/sim/robot/brc_detector.hpp"
#include "oi/dialect.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

Parameters powered(PowerOn power_on) {
  Parameters parameters;
  parameters.power_on = power_on;
  return parameters;
}

TEST(Power, IsOffUntilTheButtonIsPressed) {
  Robot robot{powered(PowerOn::never)};
  robot.send({128});
  robot.wait(10s);
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
  robot.device.press_power();
  robot.wait(4s);
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
}

TEST(Power, BootsDeafAndThenSaysWhoItIs) {
  Robot robot{powered(PowerOn::now)};
  robot.wait(2900ms);
  robot.send({128});
  EXPECT_TRUE(robot.receive().empty());
  robot.wait(400ms);
  EXPECT_EQ(text(robot.receive()).substr(0, 10), "bl-start\r\n");
  EXPECT_EQ(robot.device.power(), Power::booting);
  robot.wait(300ms);
  EXPECT_EQ(robot.device.power(), Power::on);
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
  robot.send({128});
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Power, HoldsTheDigitalOutputsHighForThreeSeconds) {
  Robot robot{powered(PowerOn::now)};
  robot.wait(2990ms);
  EXPECT_EQ(robot.device.actuators().digital_outputs, 0b111);
  robot.wait(20ms);
  EXPECT_EQ(robot.device.actuators().digital_outputs, 0);
}

TEST(Power, ForgetsEverythingWhenSwitchedOff) {
  Robot robot;
  robot.send({128, 132, 140, 0, 1, 60, 64, 152, 1, 153, 148, 1, 35, 145, 0, 200, 0, 200});
  robot.device.press_power();
  EXPECT_EQ(robot.device.power(), Power::off);
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
  robot.device.press_power();
  robot.wait(4s);
  robot.send({128, 132, 141, 0});
  EXPECT_FALSE(robot.device.songs().playing());
  EXPECT_TRUE(robot.device.script().empty());
  EXPECT_FALSE(robot.device.stream().running());
}

TEST(Power, LosesWhatWasNotSentYet) {
  Robot robot;
  robot.send({128, 129, 0});  // 300 baud
  robot.wait(200ms);
  robot.device.print(std::string(500, 'x'));  // a quarter of a minute
  robot.device.press_power();
  robot.device.press_power();
  robot.wait(4s);
  (void)robot.receive();
  robot.send({128});
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Power, FreesARobotThatWaitsForEver) {
  Robot robot;
  robot.send({128, 132, 158, 5});
  robot.device.press_power();
  robot.device.press_power();
  robot.wait(4s);
  robot.send({128});
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Power, TogglesOnTheRisingEdgeOfPin3) {
  Robot robot{powered(PowerOn::never)};
  robot.device.set_power_toggle(false);
  robot.wait(500ms);
  EXPECT_EQ(robot.device.power(), Power::off);
  robot.device.set_power_toggle(true);
  EXPECT_EQ(robot.device.power(), Power::booting);
  robot.wait(100ms);
  robot.device.set_power_toggle(true);
  EXPECT_EQ(robot.device.power(), Power::booting);
  robot.device.set_power_toggle(false);
  robot.device.set_power_toggle(true);
  EXPECT_EQ(robot.device.power(), Power::off);
}

TEST(Power, ForgetsTheBaudCommand) {
  Robot robot;
  robot.send({128, 129, 5});
  robot.wait(200ms);
  EXPECT_EQ(robot.device.baud(), 9600U);
  robot.device.press_power();
  robot.device.press_power();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(Power, BootsAt19200WithPlayHeldForFourSeconds) {
  Robot robot{powered(PowerOn::never)};
  robot.device.inputs().play_button = true;
  robot.device.press_power();
  robot.wait(3900ms);
  EXPECT_EQ(robot.device.baud(), 57600U);
  robot.wait(200ms);
  EXPECT_EQ(robot.device.baud(), 19200U);
  EXPECT_FALSE(robot.device.demos().running()) << "it was not pressed for a demo";
  robot.device.press_power();
  robot.device.inputs().play_button = false;
  robot.device.press_power();
  robot.wait(5s);
  EXPECT_EQ(robot.device.baud(), 57600U) << "until the power is turned off";
}

TEST(Power, PlaysATuneOfDescendingPitchesAt19200) {
  Robot robot{powered(PowerOn::never)};
  robot.device.inputs().play_button = true;
  robot.device.press_power();
  Bytes tune;
  for (int tick = 0; tick < 400; ++tick) {
    robot.to_tick();
    const std::uint8_t note = robot.device.sounding();
    const bool too_soon = note != 0 && robot.device.now() < 3990ms;
    EXPECT_FALSE(too_soon) << "about 4 s";
    if (note != 0 && (tune.empty() || tune.back() != note)) tune.push_back(note);
  }
  EXPECT_GE(tune.size(), 3U);
  EXPECT_TRUE(std::is_sorted(tune.rbegin(), tune.rend()));
  EXPECT_EQ(robot.device.sounding(), 0) << "it is over";
}

TEST(Power, DoesNotMindPlayLetGoTooSoon) {
  Robot robot{powered(PowerOn::never)};
  robot.device.inputs().play_button = true;
  robot.device.press_power();
  robot.wait(3800ms);
  robot.device.inputs().play_button = false;
  robot.wait(1s);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

void pulse(Robot& robot, rt::Duration low, rt::Duration high) {
  robot.device.set_brc(false);
  robot.wait(low);
  robot.device.set_brc(true);
  robot.wait(high);
}

TEST(Brc, SetsTheRateWithThreePulses) {
  Robot robot;
  for (int i = 0; i < 2; ++i) pulse(robot, 250ms, 250ms);
  EXPECT_EQ(robot.device.baud(), 57600U);
  pulse(robot, 250ms, 20ms);
  EXPECT_EQ(robot.device.baud(), 19200U);
}

TEST(Brc, JudgesEachPulseByItsWidth) {
  const auto switches = [](rt::Duration first, rt::Duration second, rt::Duration third) {
    Robot robot;
    for (const rt::Duration low : {first, second, third}) pulse(robot, low, 100ms);
    return robot.device.baud() == 19200;
  };
  EXPECT_TRUE(switches(50ms, 50ms, 50ms));
  EXPECT_TRUE(switches(500ms, 500ms, 500ms));
  EXPECT_FALSE(switches(49ms, 250ms, 250ms));
  EXPECT_FALSE(switches(250ms, 501ms, 250ms));
  EXPECT_FALSE(switches(250ms, 250ms, 1s));
}

TEST(Brc, BeginsAgainAfterABadPulse) {
  BrcDetector brc;
  rt::Duration now = 10s;
  int switched_after = 0;
  int pulses = 0;
  for (const rt::Duration low : {250ms, 250ms, 10ms, 250ms, 250ms, 250ms}) {
    ++pulses;
    EXPECT_FALSE(brc.set_level(false, now));
    now += low;
    if (brc.set_level(true, now)) switched_after = pulses;
    now += 250ms;
  }
  EXPECT_EQ(switched_after, 6);
}

// The manual sets no longest gap and no latest time (OI p. 5).
TEST(Brc, CountsPulsesHoweverLateAndFarApart) {
  Robot robot;
  robot.wait(3600s);
  for (int i = 0; i < 2; ++i) pulse(robot, 100ms, 60s);
  EXPECT_EQ(robot.device.baud(), 57600U);
  pulse(robot, 100ms, 100ms);
  EXPECT_EQ(robot.device.baud(), 19200U);
}

TEST(Brc, IsNotUndoneByMorePulses) {
  Robot robot;
  for (int i = 0; i < 7; ++i) pulse(robot, 100ms, 100ms);
  EXPECT_EQ(robot.device.baud(), 19200U);
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.send({128, 129, 10});
  robot.wait(200ms);
  for (int i = 0; i < 2; ++i) pulse(robot, 100ms, 100ms);
  EXPECT_EQ(robot.device.baud(), 19200U) << "the seventh was the first of another three";
}

// In the manual's table of packet 32 the rate follows the pin (OI p. 20), on its page 5 it takes
// pulses.
TEST(Brc, IsNotHeldLowForARate) {
  Robot robot;
  robot.device.set_brc(false);
  robot.wait(10s);
  EXPECT_EQ(robot.device.baud(), 57600U);
  robot.device.set_brc(true);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(Brc, IsIgnoredForTwoSecondsAfterPowerOn) {
  Robot robot{powered(PowerOn::now)};
  robot.wait(1900ms);
  for (int i = 0; i < 3; ++i) pulse(robot, 90ms, 90ms);
  robot.wait(2s);
  EXPECT_EQ(robot.device.baud(), 57600U) << "the first began 100 ms too early";
  for (int i = 0; i < 3; ++i) pulse(robot, 90ms, 90ms);
  EXPECT_EQ(robot.device.baud(), 19200U);
}

TEST(Brc, OutlastsThePowerButtonAndNotTheBattery) {
  Robot robot;
  for (int i = 0; i < 3; ++i) pulse(robot, 100ms, 100ms);
  robot.device.press_power();
  robot.device.press_power();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 19200U);
  robot.device.brown_out();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

TEST(Brc, YieldsToABaudCommand) {
  Robot robot;
  for (int i = 0; i < 3; ++i) pulse(robot, 100ms, 100ms);
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.send({128, 129, 5});
  robot.wait(200ms);
  EXPECT_EQ(robot.device.baud(), 9600U);
  robot.device.press_power();
  robot.device.press_power();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 57600U) << "the pulses are forgotten";
}

TEST(Brc, IsBitFourOfTheDigitalInputs) {
  Robot robot;
  robot.send({128});
  EXPECT_EQ(robot.ask({142, 32}), (Bytes{0b10000}));
  robot.device.set_brc(false);
  EXPECT_EQ(robot.ask({142, 32}), (Bytes{0}));
}

TEST(BrownOut, BootsAgainInTheMiddleOfEverything) {
  Robot robot;
  robot.send({128, 132, 148, 1, 35, 145, 0, 200, 0, 200});
  robot.wait(1s);
  robot.device.brown_out();
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
  (void)robot.receive();
  robot.wait(3600ms);
  EXPECT_NE(text(robot.receive()).find("bl-start"), std::string::npos);
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
}

TEST(Reset, IsAnExtension) {
  Robot plain;
  plain.send({128, 7});
  EXPECT_EQ(plain.device.mode(), oi::Mode::passive);
  Parameters parameters;
  parameters.dialect = &oi::kCreateWithExtensions;
  Robot robot{parameters};
  robot.send({128, 7});
  EXPECT_EQ(robot.device.power(), Power::booting);
  robot.wait(2900ms);
  EXPECT_TRUE(robot.receive().empty());
  robot.wait(1500ms);
  EXPECT_EQ(robot.device.power(), Power::booting);
  robot.wait(200ms);
  EXPECT_EQ(robot.device.power(), Power::on);
}

}  // namespace
}  // namespace cargobay::hal::sim
