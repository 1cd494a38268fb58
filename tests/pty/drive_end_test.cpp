// How `cargobay drive` ends: in every case the robot stands still, in Passive.

#include <csignal>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using hal::sim::Device;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kTable = "Wheel speed";

TEST_F(DriveTest, LeavesTheRobotStandingInPassive) {
  Command command{drive({"--duration", "0.8"})};
  EXPECT_TRUE(starts_to_move());
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
  EXPECT_THAT(command.out(), HasSubstr(kTable));
  EXPECT_THAT(command.err(), IsEmpty());
}

class DriveSignalTest : public DriveTest, public testing::WithParamInterface<int> {};

TEST_P(DriveSignalTest, StopsAndReports) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  command.send(GetParam());
  EXPECT_EQ(command.exit_code(), 128 + GetParam());
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
  EXPECT_THAT(command.out(), HasSubstr(kTable));
  EXPECT_THAT(command.err(), IsEmpty());
}

TEST_P(DriveSignalTest, EndsABringUpAsWell) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(eventually([this] { return server_->snapshot().device.bytes_received > 0; }));
  command.send(GetParam());
  EXPECT_EQ(command.exit_code(), 128 + GetParam());
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

INSTANTIATE_TEST_SUITE_P(Each, DriveSignalTest, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT),
                         [](const auto& tested) {
                           return std::string{"SIG"} + sigabbrev_np(tested.param);
                         });

TEST_F(DriveTest, StopsOnControlCOfItsTerminal) {
  Command command{drive({"--duration", "60"}), kOnTerminal};
  ASSERT_TRUE(starts_to_move());
  command.type("\x03");
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
  EXPECT_THAT(command.out(), HasSubstr(kTable));
}

TEST_F(DriveTest, GoesOnWithoutItsTerminalUnderNohup) {
  auto* const before = std::signal(SIGHUP, SIG_IGN);
  Command command{drive({"--duration", "60"})};
  std::signal(SIGHUP, before);
  ASSERT_TRUE(starts_to_move());
  command.send(SIGHUP);
  EXPECT_TRUE(drives_on());
  command.send(SIGTERM);
  EXPECT_EQ(command.exit_code(), 128 + SIGTERM);
}

// If it were suspended, it would leave the robot rolling.
TEST_F(DriveTest, StopsOnControlZOfItsTerminal) {
  Command command{drive({"--duration", "60"}), kOnTerminal};
  ASSERT_TRUE(starts_to_move());
  command.type("\x1a");
  EXPECT_EQ(command.exit_code(), 128 + SIGTSTP);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

// As in `cargobay drive | head -1`.
TEST_F(DriveTest, EndsProperlyWhereNobodyReadsItsOutput) {
  const TemporaryFolder folder;
  Command command{drive({"--duration", "0.6", "--json", folder.path("a.json")})};
  ASSERT_TRUE(starts_to_move());
  command.close_terminal();
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("Broken pipe"));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
  EXPECT_TRUE(std::filesystem::exists(folder.path("a.json"))) << "the results are not lost";
}

// As when a connection over ssh breaks.
TEST_F(DriveTest, StopsWhenItsTerminalGoesAway) {
  Command command{drive({"--duration", "60"}), kOnTerminal};
  ASSERT_TRUE(starts_to_move());
  command.close_terminal();
  EXPECT_NE(command.exit_code(), 0);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

TEST_F(DriveTest, FailsWhenThePortHangsUp) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  server_->stop();
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("plug it in and start again"));
  EXPECT_THAT(command.out(), HasSubstr(kTable));
}

TEST_F(DriveTest, FailsWhenTheRobotIsSwitchedOff) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  server_->with_device([](Device& device) { device.press_power(); });
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("check the cable and the battery"));
  EXPECT_TRUE(stands_still());
}

struct HazardCase {
  const char* name;
  void (*happen)(Device& device);
  const char* complaint;

  friend std::ostream& operator<<(std::ostream& out, const HazardCase& each) {
    return out << each.name;
  }
};

constexpr HazardCase kCliff{"Cliff",
                            [](Device& device) { device.inputs().cliff_left.cliff = true; },
                            "a cliff on the left"};
constexpr HazardCase kWheelDrop{"WheelDrop",
                                [](Device& device) { device.inputs().wheel_drop_right = true; },
                                "the right wheel is off the floor"};
constexpr HazardCase kCharger{"Charger", [](Device& device) { device.inputs().charger = true; },
                              "the charger is plugged in"};

class DriveHazardTest : public DriveTest, public testing::WithParamInterface<HazardCase> {};

TEST_P(DriveHazardTest, EndsADriveInSafe) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  server_->with_device(GetParam().happen);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine(GetParam().complaint));
  EXPECT_THAT(command.out(), HasSubstr(GetParam().complaint)) << "among the events";
  EXPECT_THAT(command.out(), HasSubstr(kTable));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

TEST_P(DriveHazardTest, DoesNotEndADriveInFull) {
  Command command{drive({"--duration", "60", "--full"})};
  ASSERT_TRUE(starts_to_move());
  server_->with_device(GetParam().happen);
  EXPECT_TRUE(drives_on());
  EXPECT_EQ(mode(), oi::Mode::full);
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

INSTANTIATE_TEST_SUITE_P(Each, DriveHazardTest, testing::Values(kCliff, kWheelDrop, kCharger),
                         [](const auto& tested) { return std::string{tested.param.name}; });

// A second command in one tick would cancel the first: the robot acts only once per tick.
TEST_F(DriveTest, CommandsOnceATick) {
  Command command{drive({"--duration", "2", "--profile", "square"})};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  std::vector<hal::sim::DriveRecord> commands = drives();
  const auto moves = [](const hal::sim::DriveRecord& record) {
    return record.command.left_mm_s != 0.0 || record.command.right_mm_s != 0.0;
  };
  ASSERT_GT(std::count_if(commands.begin(), commands.end(), moves), 100);
  while (!moves(commands.back())) commands.pop_back();  // the stop may follow at once
  for (std::size_t i = 1; i < commands.size(); ++i)
    EXPECT_NE(commands[i].tick, commands[i - 1].tick) << i;
}

TEST_F(DriveTest, NeverMovesWithoutTheRightsItRequires) {
  Command command{drive({"--duration", "60", "--require-rt"}), kNobody};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("CAP_SYS_NICE"));
  EXPECT_THAT(command.err(),
              AllOf(AnyOf(HasSubstr("/etc/security/limits.d"), HasSubstr("start the container")),
                    HasSubstr("leave out --require-rt")));
  EXPECT_THAT(command.out(), Not(HasSubstr(kTable)));
  EXPECT_EQ(mode(), oi::Mode::passive);
  for (const hal::sim::DriveRecord& record : drives())
    EXPECT_EQ(record.command, hal::sim::WheelSpeeds{});
}

TEST_F(DriveTest, SaysWhichRightsWereRefused) {
  Command command{drive({"--duration", "0.6"}), kNobody};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.err(), IsEmpty());
  EXPECT_THAT(command.out(),
              AllOf(HasSubstr("ordinary scheduling"), HasSubstr("SCHED_FIFO refused")));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

TEST_F(DriveTest, NeedsNoRightsForAVirtualCreateOfItsOwn) {
  Command command{{"drive", "--duration", "0.6"}, kNobody};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), AllOf(HasSubstr("true, mean"), HasSubstr("SCHED_FIFO refused")));
}

}  // namespace
}  // namespace cargobay::test
