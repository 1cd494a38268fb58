// What `cargobay drive` refuses: in one line that says what to do, with nothing set in motion.

#include <csignal>
#include <functional>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using hal::sim::Device;
using testing::HasSubstr;
using testing::IsEmpty;

// {folder} is a folder that holds what the tests need.
struct BadInput {
  const char* name;
  std::vector<std::string> arguments;
  const char* says;
};

std::ostream& operator<<(std::ostream& out, const BadInput& input) { return out << input.name; }

class DriveBadInputTest : public DriveTest, public testing::WithParamInterface<BadInput> {
 protected:
  DriveBadInputTest() {
    (void)folder_.write("text", "1 200 200\nfast and furious\n");
    (void)folder_.write("short", "# two numbers\n1 200\n");
    (void)folder_.write("long", "1 200 200 200\n");
    (void)folder_.write("past", "-1 200 200\n");
    (void)folder_.write("beyond", "1 200 501\n");
    (void)folder_.write("nan", "1 nan 100\n");
    (void)folder_.write("empty", "");
    (void)folder_.write("binary", std::string("\0\1\2\xff\xfe", 5));
  }

  std::vector<std::string> arguments() const {
    std::vector<std::string> all = GetParam().arguments;
    for (std::string& argument : all) {
      const std::string_view placeholder = "{folder}";
      const std::size_t at = argument.find(placeholder);
      if (at != std::string::npos) argument.replace(at, placeholder.size(), folder_.path(""));
    }
    return all;
  }

 private:
  TemporaryFolder folder_;
};

TEST_P(DriveBadInputTest, IsRefusedBeforeTheRobotHearsAnything) {
  Command command{drive(arguments())};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine(GetParam().says));
  EXPECT_THAT(command.out(), IsEmpty());
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

const BadInput kBadInputs[]{
    {"BaudTooSlow", {"--baud", "300"}, "choose 14400 baud or more"},
    {"BaudUnknown", {"--baud", "12345"}, "choose 57600"},
    {"SpeedBeyond", {"--speed", "501"}, "-500 to 500"},
    {"SpeedBeyondBackwards", {"--speed", "-501"}, "-500 to 500"},
    {"SpeedInMetres", {"--speed", "0.2"}, "metres per second? did you mean 200"},
    {"SpeedNotANumber", {"--speed", "nan"}, "-500 to 500"},
    {"SpeedOfASquareZero", {"--profile", "square", "--speed", "0"}, "choose --speed"},
    {"DurationZero", {"--duration", "0"}, "86400"},
    {"DurationNegative", {"--duration", "-1"}, "86400"},
    {"DurationInMilliseconds", {"--duration", "100000"}, "milliseconds? did you mean 100"},
    {"GuardDeadlineInSeconds", {"--guard-deadline", "0.15"}, "seconds? did you mean 150"},
    {"DurationNotANumber", {"--duration", "nan"}, "86400"},
    {"DurationEndless", {"--duration", "inf"}, "86400"},
    {"ProfileMissing", {"--profile", "{folder}none"}, "straight, steps, square, spin"},
    {"ProfileFolder", {"--profile", "{folder}"}, "straight, steps, square, spin"},
    {"ProfileText", {"--profile", "{folder}text"}, "line 2: not three numbers; a line is SECONDS"},
    {"ProfileShort", {"--profile", "{folder}short"}, "line 2: not three numbers"},
    {"ProfileLong", {"--profile", "{folder}long"}, "line 1: not three numbers"},
    {"ProfilePast", {"--profile", "{folder}past"}, "line 1: the time must be above 0"},
    {"ProfileBeyond", {"--profile", "{folder}beyond"}, "line 1: a speed is beyond"},
    {"ProfileNan", {"--profile", "{folder}nan"}, "line 1: "},
    {"ProfileEmpty", {"--profile", "{folder}empty"}, "a line is SECONDS"},
    {"ProfileBinary", {"--profile", "{folder}binary"}, "line 1: "},
    {"JsonWithoutFolder", {"--json", "{folder}none/results.json"}, "name a file in a folder"},
    {"JsonFolder", {"--json", "{folder}"}, "name a file"},
    {"PlotWithoutFolder", {"--plot", "{folder}none/plot.svg"}, "name a file in a folder"},
    {"PlotFolder", {"--plot", "{folder}"}, "name a file"},
    {"RecordWithoutFolder", {"--record", "{folder}none/drive.rec"}, "name a file in a folder"},
    {"RecordFolder", {"--record", "{folder}"}, "name a file"},
    {"RecordToStandardOutput", {"--record", "-"}, "--record needs a file name"},
};

INSTANTIATE_TEST_SUITE_P(Each, DriveBadInputTest, testing::ValuesIn(kBadInputs),
                         [](const auto& tested) { return std::string{tested.param.name}; });

class BadPortTest : public DriveTest {
 protected:
  // Expects it to refuse this port, and to say so.
  void expect_refused(const std::string& path, const std::string& says, const Setup& setup = {}) {
    port_ = path;
    Command command{drive({"--duration", "60"}), setup};
    EXPECT_EQ(command.exit_code(), 1);
    EXPECT_THAT(command.err(), OneErrorLine(says));
    EXPECT_THAT(command.err(), HasSubstr(path));
    EXPECT_THAT(command.out(), IsEmpty());
  }
};

TEST_F(BadPortTest, IsMissing) { expect_refused("/dev/no-such-port", "plug the cable in"); }

TEST_F(BadPortTest, IsInAFolderThatIsMissing) {
  expect_refused("/no/such/port", "plug the cable in");
}

TEST_F(BadPortTest, IsNoTerminal) { expect_refused("/dev/null", "name a serial port"); }

TEST_F(BadPortTest, IsAFile) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "mine");
  expect_refused(file, "name a serial port");
  EXPECT_EQ(contents(file), "mine");
}

TEST_F(BadPortTest, IsAFolder) { expect_refused("/tmp", "name a serial port"); }

TEST_F(BadPortTest, IsForbidden) {
  ASSERT_EQ(chmod(port_.c_str(), 0), 0);
  expect_refused(port_, "dialout", kNobody);
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

TEST_F(BadPortTest, IsBusy) {
  Command first{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  const std::string name = "cargobay (process " + std::to_string(first.process()) + ")";
  expect_refused(port_, "in use by another process, " + name + ": stop it");
  expect_refused(port_, "in use by another process, " + name, kNobody);
  Command doctor{{"doctor", "--port", port_}};
  EXPECT_EQ(doctor.exit_code(), 1);
  EXPECT_THAT(doctor.out(), HasSubstr(name + " has " + port_ + " open"));

  EXPECT_TRUE(drives_on());
  first.send(SIGINT);
  EXPECT_EQ(first.exit_code(), 128 + SIGINT);
  EXPECT_TRUE(stands_still());
}

TEST_F(BadPortTest, IsFreeAgainAfterADrive) {
  for (int i = 0; i < 2; ++i) {
    Command command{drive({"--duration", "0.3"})};
    EXPECT_EQ(command.exit_code(), 0) << command.err();
  }
}

TEST_F(DriveTest, FailsOnASilentRobot) {
  auto port = hal::sim::PtyPort::open("", 57600);  // nothing serves it
  ASSERT_TRUE(port);
  Command command{{"drive", "--port", (*port)->path()}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("is it switched on"));
}

TEST_F(DriveTest, FailsOnARobotThatIsOff) {
  serve({.power_on = hal::sim::PowerOn::never});
  Command command{drive()};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("is it switched on"));
  EXPECT_TRUE(stands_still());
}

TEST_F(DriveTest, FailsOnARobotInTheAir) {
  server_->with_device([](Device& device) { device.inputs().wheel_drop_left = true; });
  Command command{drive()};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("set it on its wheels"));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

TEST_F(DriveTest, RefusesAProfileItMayNotRead) {
  const TemporaryFolder folder;
  const std::string profile = folder.write("profile", "1 200 200\n");
  ASSERT_EQ(chmod(profile.c_str(), 0), 0);
  Command command{drive({"--profile", profile}), kNobody};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("cannot read the profile"));
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

// It is not known before the drive is over.
TEST_F(DriveTest, FailsWhereItsResultsCannotBeWrittenAfterAll) {
  const TemporaryFolder folder;
  const std::string gone = folder.path("gone");
  std::filesystem::create_directory(gone);
  Command command{drive({"--duration", "0.6", "--json", gone + "/a.json"})};
  ASSERT_TRUE(starts_to_move());
  std::filesystem::remove(gone);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("a.json: No such file or directory; name a file"));
  EXPECT_THAT(command.out(), HasSubstr("Wheel speed"));
  EXPECT_TRUE(stands_still());
}

struct Misuse {
  const char* name;
  std::vector<std::string> arguments;
  const char* says;
};

std::ostream& operator<<(std::ostream& out, const Misuse& misuse) { return out << misuse.name; }

class MisuseTest : public testing::TestWithParam<Misuse> {};

TEST_P(MisuseTest, EndsWithTwo) {
  Command command{GetParam().arguments};
  EXPECT_EQ(command.exit_code(), 2);
  EXPECT_THAT(command.err(), OneErrorLine(GetParam().says));
  EXPECT_THAT(command.err(), HasSubstr("--help"));
  EXPECT_THAT(command.out(), IsEmpty());
}

const Misuse kMisuses[]{
    {"NoSubcommand", {}, "which command"},
    {"UnknownSubcommand", {"fly"}, ""},
    {"UnknownOption", {"drive", "--fly"}, "--fly"},
    {"OptionWithoutValue", {"drive", "--port"}, "--port"},
    {"SpeedInWords", {"drive", "--speed", "fast"}, "--speed"},
    {"PriorityTooLow", {"drive", "--priority", "0"}, "--priority"},
    {"PriorityTooHigh", {"drive", "--priority", "99"}, "--priority"},
    {"RemainderMaybe", {"drive", "--remainder", "maybe"}, "--remainder"},
    {"ChecksumMaybe", {"sim", "--checksum", "maybe"}, "--checksum"},
    {"SimUnknownOption", {"sim", "--fly"}, "--fly"},
};

INSTANTIATE_TEST_SUITE_P(Each, MisuseTest, testing::ValuesIn(kMisuses),
                         [](const auto& tested) { return std::string{tested.param.name}; });

}  // namespace
}  // namespace cargobay::test
