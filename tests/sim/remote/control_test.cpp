#include "hal/sim/remote/control.hpp"

#include <string>

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Controlled : Robot {
  using Robot::Robot;
  std::string say(std::string_view line) { return control(line, link.cable()); }
  // The number after a key of the state; -1 if there is none.
  double state(const std::string& key) {
    const std::string json = say("state");
    const std::size_t at = json.find("\"" + key + "\":");
    return at == std::string::npos ? -1.0 : std::stod(json.substr(at + key.size() + 3));
  }
};

// What a sensor packet says a tick after the command.
struct SensorCase {
  const char* command;
  std::uint8_t packet;
  Bytes expected;
};

TEST(Control, HoldsThingsToTheSensors) {
  const SensorCase cases[] = {
      {"bump left", 7, {0b10}},
      {"bump right", 7, {0b01}},
      {"bump both", 7, {0b11}},
      {"bump none", 7, {0}},
      {"wheeldrop left on", 7, {0b1000}},
      {"wheeldrop right on", 7, {0b100}},
      {"wheeldrop caster on", 7, {0b10000}},
      {"cliff left on", 9, {1}},
      {"cliff front_left on", 10, {1}},
      {"cliff front_right on", 11, {1}},
      {"cliff right on", 12, {1}},
      {"wall on", 8, {1}},
      {"virtual-wall on", 13, {1}},
      {"charger on", 34, {1}},
      {"home-base on", 34, {2}},
      {"ir 129", 17, {129}},
      {"digital-in 3 1", 32, {0b11000}},
      {"analog-in 1023", 33, {3, 255}},
      {"overcurrent ld1 on", 14, {1}},
      {"overcurrent ld0 on", 14, {2}},
      {"overcurrent ld2 on", 14, {4}},
      {"overcurrent right_wheel on", 14, {8}},
      {"overcurrent left_wheel on", 14, {16}},
      {"hold play", 18, {1}},
      {"hold advance", 18, {4}},
      {"brc low", 32, {0}},
  };
  for (const SensorCase& each : cases) {
    Controlled robot;
    robot.send({128});
    EXPECT_EQ(robot.say(each.command), "ok") << each.command;
    robot.to_tick();
    EXPECT_EQ(robot.ask({142, each.packet}), each.expected) << each.command;
  }
}

// By command, just as in a world (OI p. 17).
TEST(Control, TripsTheVirtualWallSensorWithAForceField) {
  Controlled robot;
  robot.send({128});
  const auto tripped = [&robot](const std::string& command) {
    EXPECT_EQ(robot.say(command), "ok");
    robot.to_tick();
    return robot.ask({142, 13}) == Bytes{1};
  };
  for (const int byte : {242, 246, 250, 254}) {
    EXPECT_TRUE(tripped("ir " + std::to_string(byte))) << byte;
  }
  for (const int byte : {240, 244, 248, 252, 255, 2, 130, 243}) {
    EXPECT_FALSE(tripped("ir " + std::to_string(byte))) << byte;
  }
  EXPECT_TRUE(tripped("home-base on"));
  EXPECT_TRUE(tripped("ir 255"));
  EXPECT_EQ(robot.ask({142, 17}), (Bytes{254})) << "in the middle of both buoys";
  EXPECT_FALSE(tripped("home-base off"));
  EXPECT_EQ(robot.ask({142, 17}), (Bytes{255}));
}

TEST(Control, TakesThingsAwayAgain) {
  Controlled robot;
  robot.send({128});
  for (const char* command :
       {"cliff left on", "cliff left off", "wheeldrop left on", "wheeldrop left off", "wall on",
        "wall off", "hold play", "release play"}) {
    EXPECT_EQ(robot.say(command), "ok") << command;
  }
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 1}), Bytes(10, 0));
  EXPECT_EQ(robot.ask({142, 18}), (Bytes{0}));
}

TEST(Control, PressesAButtonForAWhile) {
  Controlled robot;
  robot.send({128, 132});
  EXPECT_EQ(robot.say("press advance 500"), "ok");
  robot.wait(480ms);
  EXPECT_EQ(robot.ask({142, 18}), (Bytes{4}));
  robot.wait(60ms);
  EXPECT_EQ(robot.ask({142, 18}), (Bytes{0}));
}

TEST(Control, PressesThePowerButtonAndMovesThePins) {
  Controlled robot;
  EXPECT_EQ(robot.say("power"), "ok");
  EXPECT_EQ(robot.device.power(), Power::off);
  EXPECT_EQ(robot.say("power-toggle low"), "ok");
  EXPECT_EQ(robot.say("power-toggle high"), "ok");
  EXPECT_EQ(robot.device.power(), Power::booting);
  robot.wait(4s);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(robot.say("brc low"), "ok");
    robot.wait(100ms);
    EXPECT_EQ(robot.say("brc high"), "ok");
    robot.wait(100ms);
  }
  EXPECT_EQ(robot.state("baud"), 19200.0);
}

TEST(Control, PlacesTheRobotAndSetsItsBattery) {
  Controlled robot;
  EXPECT_EQ(robot.say("place 100 -200.5 270"), "ok");
  EXPECT_EQ(robot.say("battery 1000"), "ok");
  EXPECT_DOUBLE_EQ(robot.state("x_mm"), 100.0);
  EXPECT_DOUBLE_EQ(robot.state("y_mm"), -200.5);
  EXPECT_DOUBLE_EQ(robot.state("heading_deg"), -90.0);
  EXPECT_NEAR(robot.state("battery_mah"), 1000.0, 0.1);
}

TEST(Control, TellsTheWholeState) {
  Controlled robot;
  robot.send({128, 132, 139, 8,   9, 10,  144, 1,   2, 3,   147, 5,  148,
              2,   35,  7,   152, 2, 142, 35,  145, 0, 200, 0,   100});
  robot.wait(2s);
  const std::string json = robot.say("state");
  EXPECT_EQ(json.find('\n'), std::string::npos);
  for (const char* part :
       {"\"mode\":\"full\"", "\"baud\":57600", "\"powered\":true", "\"pose\":{\"x_mm\":",
        "\"commanded_mm_s\":{\"left\":100.000,\"right\":200.000}", "\"song_playing\":false",
        "\"leds\":{\"play\":false,\"advance\":true,\"power_color\":9,\"power_intensity\":10}",
        "\"digital_out\":5", "\"low_side_driver\":[3,2,1]", "\"script_bytes\":2",
        "\"charging_state\":0", "\"stream_packets\":2", "\"brc\":\"high\"", "\"counters\":{",
        "\"wheel_mm_s\":{\"left\":9"}) {
    EXPECT_NE(json.find(part), std::string::npos) << part << " in " << json;
  }
}

TEST(Control, ShowsThePinsOfTheCargoBay) {
  Controlled robot;
  robot.to_tick();
  const double vpwr_mv = robot.state("vpwr_mv");
  EXPECT_NEAR(vpwr_mv, 15600.0, 100.0);
  EXPECT_EQ(robot.state("switched_vpwr_mv"), vpwr_mv);
  const auto shows = [&robot](const std::string& part) {
    return robot.say("state").find(part) != std::string::npos;
  };
  EXPECT_TRUE(shows("\"pins\":{\"charging\":false,\"switched_5v\":true,"));
  EXPECT_EQ(robot.say("charger on"), "ok");
  robot.to_tick();
  EXPECT_TRUE(shows("\"pins\":{\"charging\":true,\"switched_5v\":true,"));
  EXPECT_EQ(robot.say("power"), "ok");
  EXPECT_TRUE(shows("\"pins\":{\"charging\":true,\"switched_5v\":false,"));
  EXPECT_GT(robot.state("vpwr_mv"), 15000.0) << "the battery itself";
  EXPECT_EQ(robot.state("switched_vpwr_mv"), 0.0);
}

TEST(Control, ShowsWhatFlowsThroughTheDrivers) {
  Controlled robot;
  robot.send({128, 132, 138, 4});
  EXPECT_EQ(robot.say("overcurrent ld2 on"), "ok");
  robot.to_tick();
  EXPECT_NE(robot.say("state").find("\"low_side_driver\":[0,0,128],"
                                    "\"low_side_driver_ma\":[0,0,1600]"),
            std::string::npos);
}

TEST(Control, TurnsTheWheelsByHand) {
  Controlled robot;
  robot.send({128});
  EXPECT_EQ(robot.say("turn-wheels -100 -100"), "ok");
  robot.wait(2s);
  EXPECT_EQ(robot.say("turn-wheels 0 0"), "ok");
  EXPECT_LT(robot.state("x_mm"), -150.0);
  EXPECT_GT(word(robot.ask({142, 19}), 0), 150) << "counted up";
}

TEST(Control, HindersChargingAndChangesTheBattery) {
  Controlled robot;
  EXPECT_EQ(robot.say("charger on"), "ok");
  for (const auto& [trouble, state] :
       {std::pair{"waiting", 4.0}, std::pair{"fault", 5.0}, std::pair{"normal", 2.0}}) {
    EXPECT_EQ(robot.say(std::string{"charging "} + trouble), "ok");
    robot.to_tick();
    EXPECT_EQ(robot.state("charging_state"), state) << trouble;
  }
  EXPECT_EQ(robot.say("battery-pack alkaline"), "ok");
  EXPECT_NE(robot.say("state").find("\"battery_pack\":\"alkaline\""), std::string::npos);
  EXPECT_NE(robot.say("state").find("\"powered\":false"), std::string::npos);
  EXPECT_EQ(robot.say("battery-pack rechargeable"), "ok");
  EXPECT_NE(robot.say("state").find("\"battery_pack\":\"rechargeable\""), std::string::npos);
}

TEST(Control, MakesThingsGoWrong) {
  Controlled robot;
  EXPECT_EQ(robot.say("fault jitter 5\r"), "ok");
  EXPECT_EQ(robot.link.cable().faults_to_host().jitter, 5ms);
  EXPECT_EQ(robot.say("fault").substr(0, 7), "error: ");
  EXPECT_EQ(robot.say("fault jitter").substr(0, 21), "error: the usage is '");
}

TEST(Control, SaysWhatIsWrong) {
  Controlled robot;
  for (const char* bad : {"power on",
                          "press",
                          "press stop",
                          "press play x",
                          "press play 1 2",
                          "hold",
                          "hold it",
                          "bump",
                          "bump up",
                          "bump left on",
                          "wheeldrop left",
                          "wheeldrop middle on",
                          "cliff on",
                          "cliff left maybe",
                          "wall",
                          "wall high",
                          "ir",
                          "ir 256",
                          "ir -1",
                          "ir 1.5",
                          "digital-in 4 1",
                          "digital-in 0 2",
                          "analog-in 1024",
                          "overcurrent ld3 on",
                          "brc",
                          "brc on",
                          "battery",
                          "battery -1",
                          "battery-pack",
                          "battery-pack nuclear",
                          "charging",
                          "charging on",
                          "charging fault now",
                          "turn-wheels 1",
                          "turn-wheels 1 1001",
                          "turn-wheels 1 2 3",
                          "place 1 2",
                          "place a b c",
                          "place 1 2 3 4",
                          "state now",
                          "help me"}) {
    EXPECT_EQ(robot.say(bad).substr(0, 21), "error: the usage is '")
        << bad << ": " << robot.say(bad);
  }
  EXPECT_NE(robot.say("dance").find("unknown command 'dance'"), std::string::npos);
  EXPECT_EQ(robot.say("").substr(0, 7), "error: ");
}

TEST(Control, AnswersEveryCommandThatItLists) {
  Controlled robot;
  for (const ControlInfo& info : controls()) {
    const std::string answer = robot.say(info.name);
    EXPECT_EQ(answer.find("unknown command"), std::string::npos) << info.name;
    EXPECT_EQ(answer.find('\n'), std::string::npos) << info.name;
  }
}

TEST(Control, DoesThingsLater) {
  Controlled robot;
  EXPECT_EQ(robot.say("at 1.5 bump left"), "ok");
  EXPECT_EQ(robot.say("at 0.5 cliff left on"), "ok");
  const auto pressed = [&] { return robot.device.inputs().bump_left; };
  robot.wait(std::chrono::milliseconds{499});
  EXPECT_FALSE(robot.device.inputs().cliff_left.cliff);
  robot.wait(std::chrono::milliseconds{2});
  EXPECT_TRUE(robot.device.inputs().cliff_left.cliff);
  EXPECT_FALSE(pressed());
  robot.wait(std::chrono::milliseconds{1000});
  EXPECT_TRUE(pressed());
}

TEST(Control, DoesWhatIsOverdueAtOnce) {
  Controlled robot;
  robot.wait(std::chrono::seconds{1});
  EXPECT_EQ(robot.say("at 0.5 bump left"), "ok");
  EXPECT_TRUE(robot.device.inputs().bump_left);
}

TEST(Control, RefusesWhatItCannotDoLater) {
  Controlled robot;
  for (const char* line : {"at", "at 1", "at x bump left", "at -1 bump left", "at 1e9 bump left"})
    EXPECT_EQ(robot.say(line), "error: the usage is 'at SECONDS COMMAND'") << line;
  EXPECT_EQ(robot.say("at 1 bumb left").substr(0, 28), "error: unknown command 'bumb");
  EXPECT_EQ(robot.say("at 1 bump sideways"), "error: the usage is 'bump none|left|right|both'");
  EXPECT_EQ(robot.say("at 0 at 0 bump left").substr(0, 11), "error: `at`");
}

TEST(Control, KeepsAThousandForLater) {
  Controlled robot;
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(robot.say("at 1 bump left"), "ok");
  EXPECT_EQ(robot.say("at 1 bump left").substr(0, 11), "error: 1000");
  robot.wait(std::chrono::milliseconds{1001});
  EXPECT_EQ(robot.say("at 9 bump left"), "ok");
}

}  // namespace
}  // namespace cargobay::hal::sim
