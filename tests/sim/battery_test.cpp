// OI p. 19: charging and how it shows; p. 6: when it ends.
#include "hal/sim/battery.hpp"

#include <string>

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers
using oi::ChargingState;

TEST(Battery, IsDrainedByWhatItDrives) {
  Robot robot;
  robot.send({128, 132});
  const double before = robot.device.battery().charge_mah();
  robot.wait(360s);
  const double idle = before - robot.device.battery().charge_mah();
  EXPECT_NEAR(idle, 25.0, 0.1);  // 250 mA for a tenth of an hour
  robot.send({145, 1, 244, 1, 244});
  robot.wait(360s);
  EXPECT_GT(before - robot.device.battery().charge_mah(), 2.5 * idle);
}

TEST(Battery, ReportsItselfInItsPackets) {
  Robot robot;
  robot.send({128});
  robot.to_tick();
  const Bytes reply = robot.ask({142, 3});
  ASSERT_EQ(reply.size(), 10U);
  EXPECT_EQ(reply[0], 0);
  EXPECT_NEAR(word(reply, 1), 15600, 100);
  EXPECT_EQ(word(reply, 3), -250);
  EXPECT_EQ(reply[5], 24);
  EXPECT_EQ(word(reply, 6), 2200);
  EXPECT_EQ(word(reply, 8), 2696);
}

TEST(Battery, SwitchesTheRobotOffWhenItIsEmpty) {
  Robot robot;
  robot.send({128, 132, 145, 0, 200, 0, 200});
  robot.device.battery().set_charge_mah(0.0001);
  robot.wait(100ms);
  EXPECT_EQ(robot.device.power(), Power::off);
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
}

TEST(Charging, BeginsWithEitherSource) {
  for (bool Inputs::* source : {&Inputs::charger, &Inputs::home_base}) {
    Robot robot;
    robot.send({128});
    robot.device.inputs().*source = true;
    const double before = robot.device.battery().charge_mah();
    robot.wait(360s);
    EXPECT_EQ(robot.device.battery().state(), ChargingState::full);
    EXPECT_NEAR(robot.device.battery().charge_mah() - before, 127.0, 0.1);
  }
}

TEST(Charging, TricklesWhenFullAndReconditionsWhenEmpty) {
  Robot robot;
  robot.send({128});
  robot.device.inputs().charger = true;
  robot.device.battery().set_charge_mah(1e9);
  robot.wait(100ms);
  EXPECT_EQ(robot.device.battery().state(), ChargingState::trickle);
  robot.device.battery().set_charge_mah(10.0);
  robot.wait(100ms);
  EXPECT_EQ(robot.device.battery().state(), ChargingState::reconditioning);
}

TEST(Charging, EndsInFullMode) {
  Robot robot;
  robot.send({128});
  robot.device.inputs().charger = true;
  robot.wait(1s);
  robot.send({132});
  robot.to_tick();
  robot.wait(10ms);  // a line of text may be in flight
  (void)robot.receive();
  EXPECT_EQ(robot.ask({149, 2, 21, 34}), (Bytes{0, 1}));
}

TEST(Charging, PrintsALineASecond) {
  Robot robot;
  robot.device.inputs().charger = true;
  robot.wait(2100ms);
  const std::string lines = text(robot.receive());
  EXPECT_EQ(lines.substr(0, 21), "bat:   min 0  sec 1  ");
  EXPECT_NE(lines.find("bat:   min 0  sec 2  mV "), std::string::npos);
  EXPECT_NE(lines.find("mA 1270  deg-C 24  \r\n"), std::string::npos);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2);
}

TEST(Charging, PrintsBetweenFramesNotWithinThem) {
  Robot robot;
  robot.send({128, 148, 1, 6});
  robot.device.inputs().charger = true;
  robot.wait(3s);
  const std::string bytes = text(robot.receive());
  for (std::size_t at = bytes.find("bat:"); at != std::string::npos;
       at = bytes.find("bat:", at + 1)) {
    const std::size_t end = bytes.find('\n', at);
    ASSERT_NE(end, std::string::npos);
    EXPECT_EQ(bytes.substr(end + 1, 2), "\x13\x35");
  }
}

TEST(Charging, PrintsNothingWhereItIsToldNotTo) {
  Parameters parameters;
  parameters.charging_text = false;
  Robot robot{parameters};
  robot.device.inputs().charger = true;
  robot.wait(5s);
  EXPECT_TRUE(robot.receive().empty());
}

TEST(Charging, GoesOnWhileTheRobotIsOff) {
  Parameters parameters;
  parameters.power_on = PowerOn::never;
  Robot robot{parameters};
  robot.device.inputs().charger = true;
  robot.wait(1100ms);
  EXPECT_EQ(text(robot.receive()).substr(0, 4), "bat:");
}

TEST(Charging, WaitsAndFailsWhereItIsToldTo) {
  Robot robot;
  robot.send({128});
  robot.device.inputs().charger = true;
  for (const auto& [trouble, state] :
       {std::pair{ChargingTrouble::waiting, 4}, std::pair{ChargingTrouble::fault, 5}}) {
    robot.device.battery().set_trouble(trouble);
    const double before = robot.device.battery().charge_mah();
    robot.wait(2s);
    (void)robot.receive();
    EXPECT_EQ(robot.ask({149, 2, 21, 34}), (Bytes{static_cast<std::uint8_t>(state), 1}));
    EXPECT_LE(robot.device.battery().charge_mah(), before);
    EXPECT_FALSE(robot.device.battery().charging()) << "pin 13 is low, and it prints nothing";
    robot.wait(2s);
    EXPECT_TRUE(robot.receive().empty());
  }
  robot.device.battery().set_trouble(ChargingTrouble::none);
  robot.wait(100ms);
  EXPECT_TRUE(robot.device.battery().charging());
}

TEST(Charging, HasNoTroubleWithoutASource) {
  Robot robot;
  robot.send({128});
  robot.device.battery().set_trouble(ChargingTrouble::fault);
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 21}), (Bytes{0}));
}

TEST(BatteryPack, ForgetsEverythingWhenItIsChanged) {
  Robot robot;
  robot.send({128, 129, 5});
  robot.wait(200ms);
  robot.device.change_battery(BatteryPack::rechargeable);
  EXPECT_EQ(robot.device.power(), Power::off);
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
  EXPECT_EQ(robot.device.battery().charge_mah(), 2696.0) << "it is full";
  robot.device.press_power();
  robot.wait(4s);
  EXPECT_EQ(robot.device.baud(), 57600U);
}

// OI p. 19: packets 25 and 26 are inaccurate with alkaline cells.
TEST(BatteryPack, OfAlkalineCellsIsNotWhatThePacketsSay) {
  Robot robot;
  robot.device.change_battery(BatteryPack::alkaline);
  robot.device.press_power();
  robot.wait(4s);
  (void)robot.receive();
  robot.send({128});
  const Bytes packets = robot.ask({149, 3, 22, 25, 26});
  ASSERT_EQ(packets.size(), 6U);
  EXPECT_NEAR(word(packets, 0), 18000, 100) << "twelve fresh cells";
  EXPECT_EQ(word(packets, 4), 2696);
  EXPECT_NEAR(word(packets, 2), 2696, 1);
  EXPECT_NEAR(robot.device.battery().charge_mah(), 2000.0, 1.0);
  robot.device.battery().set_charge_mah(0.0001);
  robot.wait(100ms);
  EXPECT_EQ(robot.device.power(), Power::off) << "with 696 mAh left by its own count";
}

TEST(BatteryPack, OfAlkalineCellsIsNotCharged) {
  Robot robot;
  robot.device.change_battery(BatteryPack::alkaline);
  robot.device.battery().set_charge_mah(1000.0);
  robot.device.inputs().charger = true;
  robot.wait(60s);
  EXPECT_LE(robot.device.battery().charge_mah(), 1000.0);
  EXPECT_EQ(robot.device.battery().state(), ChargingState::fault);
}

}  // namespace
}  // namespace cargobay::hal::sim
