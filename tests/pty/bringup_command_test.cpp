// `cargobay bringup`, `ports` and `pins`, and the configuration file that the options override.
#include <csignal>

#include <nlohmann/json.hpp>

#include "drive_fixture.hpp"
#include "tests/pty/shell.hpp"

namespace cargobay::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

class BringupCommand : public DriveTest {
 protected:
  std::vector<std::string> bringup(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"bringup", "--port", port_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::uint32_t robot_baud() const { return server_->snapshot().baud; }
};

TEST(VirtualBringup, GoesFromOffTo19200ByPulses) {
  Command command{{"bringup", "--baud", "19200", "--json", "-"}};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  const json result = json::parse(command.out());
  EXPECT_EQ(result.at("ok"), true);
  EXPECT_EQ(result.at("rate_change"), "brc");
  EXPECT_EQ(result.at("powered_on"), true);
  EXPECT_EQ(result.at("mode"), "passive");
  EXPECT_EQ(result.at("brc_pulses").size(), 6U);
  EXPECT_GE(result.at("steps").size(), 5U);
  EXPECT_EQ(result.at("robot"), "virtual Create");
}

TEST(VirtualBringup, IsWhatADriveAt19200BeginsWith) {
  Command command{{"drive", "--baud", "19200", "--duration", "0.6", "--json", "-"}};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  const json result = json::parse(command.out());
  EXPECT_EQ(result.at("baud"), 19200);
  EXPECT_GT(result.at("frames_good"), 0);
}

TEST(VirtualBringup, EndsAtASignal) {
  Command command{{"bringup", "--baud", "19200"}};
  ASSERT_TRUE(eventually([&] {
    (void)command.running();
    return command.out().find("BRC wait") != std::string::npos;
  }));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
}

TEST_F(BringupCommand, PrintsItsStepsAndLeavesTheRobotPassive) {
  Command command{bringup()};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), HasSubstr("Start          at 57600 baud"));
  EXPECT_THAT(command.out(), HasSubstr("passive mode at 57600 baud"));
  EXPECT_EQ(mode(), oi::Mode::passive);
}

TEST_F(BringupCommand, LeavesItInTheModeAskedFor) {
  Command command{bringup({"--mode", "full"})};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(mode(), oi::Mode::full);
}

TEST_F(BringupCommand, FindsARobotAtAnotherRate) {
  serve({.boot_baud = 19200});
  Command command{bringup()};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), HasSubstr("found at 19200"));
  EXPECT_EQ(robot_baud(), 57600U);
}

TEST_F(BringupCommand, IsWhatADriveBeginsWith) {
  serve({.boot_baud = 19200});
  Command command{drive({"--duration", "0.3"})};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(robot_baud(), 57600U);
}

// A login prompt on the port would do the same.
TEST_F(BringupCommand, TellsWhatWentWrongInJsonToo) {
  serve({.power_on = hal::sim::PowerOn::never});
  const Shell holder{"exec 3<>" + port_ + "; while :; do sleep 1; done"};
  Command command{bringup({"--json", "-"})};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("bring-up failed at step"));
  const json result = json::parse(command.out());
  EXPECT_EQ(result.at("ok"), false);
  EXPECT_THAT(result.at("error").get<std::string>(), HasSubstr("silent"));
  EXPECT_THAT(result.at("error").get<std::string>(),
              HasSubstr(holder.name() + " also has the port open and takes bytes from it"));
}

TEST_F(BringupCommand, RefusesALineThatIsNotThere) {
  Command command{bringup({"--brc-chip", "no-such-chip", "--brc-line", "17"})};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("chip"));
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

TEST_F(BringupCommand, WantsALineWithItsChip) {
  Command command{bringup({"--brc-chip", "pinctrl-bcm2835"})};
  EXPECT_EQ(command.exit_code(), 2);
  EXPECT_THAT(command.err(), OneErrorLine("--brc-line"));
}

TEST_F(BringupCommand, TakesPortAndRateFromTheConfiguration) {
  const TemporaryFolder folder;
  const std::string config = folder.write(
      "my.toml", "port = \"" + port_ + "\"\nbaud = 19200\n[realtime]\npriority = 60\n");
  Command command{{"bringup", "--config", config}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(robot_baud(), 19200U);
  Command overridden{{"bringup", "--config", config, "--baud", "57600"}};
  EXPECT_EQ(overridden.exit_code(), 0) << overridden.err();
  EXPECT_EQ(robot_baud(), 57600U);
  Command driven{{"drive", "--config", config, "--duration", "0.3", "--json", "-"}};
  ASSERT_EQ(driven.exit_code(), 0) << driven.err();
  EXPECT_EQ(json::parse(driven.out()).at("port"), port_);
}

TEST_F(BringupCommand, LeavesTheRobotAloneWhereAVirtualOneIsWanted) {
  const TemporaryFolder folder;
  const std::string config = folder.write("my.toml", "port = \"" + port_ + "\"\n");
  Command command{{"drive", "--virtual", "--config", config, "--duration", "0.1"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

TEST(Configuration, IsRefusedByLineAndNearestKey) {
  const TemporaryFolder folder;
  const std::string config = folder.write("my.toml", "port = 'x'\nbuad = 19200\n");
  for (const char* command_name : {"bringup", "drive", "sensors"}) {
    Command command{{command_name, "--config", config}};
    EXPECT_EQ(command.exit_code(), 1) << command_name;
    EXPECT_THAT(command.err(), OneErrorLine("my.toml:2: unknown key buad; did you mean baud?"));
  }
}

// As drive and bringup do, but those say in what they print whose robot it is.
TEST(Configuration, MayLackAPort) {
  Command sensors{{"sensors", "--config", "/dev/null", "--packets", "oi_mode"}};
  EXPECT_EQ(sensors.exit_code(), 0) << sensors.err();
  EXPECT_THAT(sensors.out(), HasSubstr("(passive)"));
  EXPECT_THAT(sensors.err(), HasSubstr("a virtual Create of its own"));
  Command send{{"send", "--config", "/dev/null", "start; safe; sensors oi_mode"}};
  EXPECT_EQ(send.exit_code(), 0) << send.err();
  EXPECT_THAT(send.out(), HasSubstr("(safe)"));
  EXPECT_THAT(send.err(), HasSubstr("a virtual Create of its own"));
}

TEST(Lists, OfPortsAndPinsAreNeverEmpty) {
  for (const char* command_name : {"ports", "pins"}) {
    Command command{{command_name}};
    EXPECT_EQ(command.exit_code(), 0) << command_name;
    EXPECT_THAT(command.err(), IsEmpty());
    EXPECT_NE(command.out(), "");
  }
}

}  // namespace
}  // namespace cargobay::test
