// The files that commands are told to read and write: none is waited for, destroyed, or taken for
// another.

#include <array>
#include <csignal>
#include <sstream>
#include <utility>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

// A command with everything it needs except the file. {port}, {rec} and {json} are the robot, a
// recording and a result of `jitter`.
struct NamedFile {
  const char* name;
  Words command;
  const char* option;
  const char* suffix = "";  // what the command adds to the name
};

std::ostream& operator<<(std::ostream& out, const NamedFile& named) { return out << named.name; }

class NamedFilesTest : public DriveTest, public testing::WithParamInterface<NamedFile> {
 protected:
  NamedFilesTest() {
    (void)folder_.write("drive.rec", "no recording");
    (void)folder_.write("jitter.json", "{}");
  }

  Words words(Words all) const {
    for (std::string& word : all) {
      if (word == "{port}") word = port_;
      if (word == "{rec}") word = folder_.path("drive.rec");
      if (word == "{json}") word = folder_.path("jitter.json");
    }
    return all;
  }
  Words with_file(const std::string& file) const {
    Words all = words(GetParam().command);
    if (*GetParam().option != '\0') all.emplace_back(GetParam().option);
    all.push_back(file);
    return all;
  }
  void expect_refused(const std::string& file, const char* says) const {
    Command command{with_file(file)};
    EXPECT_EQ(command.exit_code(), 1) << file;
    EXPECT_THAT(command.err(), OneErrorLine(says)) << file;
    EXPECT_THAT(command.out(), IsEmpty());
    EXPECT_EQ(server_->snapshot().device.bytes_received, 0U) << file;
  }

  const TemporaryFolder folder_;
};

const std::array<NamedFile, 15> kOutputs{{
    {"DriveRecord", {"drive", "--port", "{port}"}, "--record"},
    {"DriveJson", {"drive", "--port", "{port}"}, "--json"},
    {"DrivePlot", {"drive", "--port", "{port}"}, "--plot"},
    {"CalibrateWrite", {"calibrate", "--port", "{port}"}, "--write"},
    {"CalibrateJson", {"calibrate", "--port", "{port}"}, "--json"},
    {"BringupJson", {"bringup", "--port", "{port}"}, "--json"},
    {"DoctorJson", {"doctor", "--port", "{port}"}, "--json"},
    {"SimTrace", {"sim"}, "--trace"},
    {"PlotOutput", {"plot", "{rec}"}, "--output"},
    {"ReplayJson", {"replay", "{rec}"}, "--json"},
    {"JitterJson", {"jitter", "--port", "{port}"}, "--json"},
    {"JitterPlot", {"jitter", "--port", "{port}"}, "--plot"},
    {"JitterCyclictest", {"jitter", "--port", "{port}"}, "--cyclictest"},
    {"JitterHgrm", {"jitter", "--port", "{port}"}, "--hgrm", "-echo.hgrm"},
    {"JitterComparePlot", {"jitter", "compare", "{json}", "{json}"}, "--plot"},
}};

class OutputsTest : public NamedFilesTest {};

TEST_P(OutputsTest, DoNotWaitForTheReaderOfAFifo) {
  const std::string fifo = folder_.path("fifo");
  ASSERT_EQ(mkfifo((fifo + GetParam().suffix).c_str(), 0600), 0);
  expect_refused(fifo, "it is a pipe that nothing reads; start its reader first");
}

TEST_P(OutputsTest, AreNeverPorts) {
  const std::string link = folder_.path("create");
  fs::create_symlink(port_, link + GetParam().suffix);
  expect_refused(link, "it is a port, a terminal or another device");
  if (*GetParam().suffix == '\0') expect_refused(port_, "it is a port");
}

TEST_P(OutputsTest, AreFoundUnwritableBeforeAnything) {
  expect_refused(folder_.path("none/file"), "name a file in a folder that exists");
}

INSTANTIATE_TEST_SUITE_P(Each, OutputsTest, testing::ValuesIn(kOutputs),
                         [](const auto& tested) { return std::string{tested.param.name}; });

const std::array<NamedFile, 12> kInputs{{
    {"DriveConfig", {"drive", "--port", "{port}"}, "--config"},
    {"DriveProfile", {"drive", "--port", "{port}"}, "--profile"},
    {"CalibrateConfig", {"calibrate", "--port", "{port}"}, "--config"},
    {"BringupConfig", {"bringup", "--port", "{port}"}, "--config"},
    {"JitterConfig", {"jitter", "--port", "{port}"}, "--config"},
    {"SensorsConfig", {"sensors", "--port", "{port}"}, "--config"},
    {"SendConfig", {"send", "--port", "{port}", "start"}, "--config"},
    {"SimWorld", {"sim"}, "--world"},
    {"Replay", {"replay"}, ""},
    {"Plot", {"plot", "--output", "-"}, ""},
    {"JitterCompare", {"jitter", "compare", "{json}"}, ""},
    {"DecodeBinary", {"decode"}, "--binary"},
}};

class InputsTest : public NamedFilesTest {};

TEST_P(InputsTest, AreNotWaitedFor) {
  const std::string fifo = folder_.path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  if (std::string_view{GetParam().name} == "JitterCompare") {
    (void)folder_.write("jitter.json", "");
    fs::remove(folder_.path("jitter.json"));
    fs::create_symlink(fifo, folder_.path("jitter.json"));
  }
  expect_refused(fifo, "it is a pipe that nothing writes to");
}

TEST_P(InputsTest, EndWhereTheyHaveNoEnd) {
  fs::remove(folder_.path("jitter.json"));
  fs::create_symlink("/dev/zero", folder_.path("jitter.json"));
  expect_refused("/dev/zero", "it is a device; name a file");
}

INSTANTIATE_TEST_SUITE_P(Each, InputsTest, testing::ValuesIn(kInputs),
                         [](const auto& tested) { return std::string{tested.param.name}; });

// Every option that takes the name of a file is in one of the tables. Those in its help that name
// an existing thing, or one made by something else, are listed here.
TEST(NamedFiles, AreAllTested) {
  const Words others{"--port", "--link", "--control", "--live"};
  for (const char* command :
       {"drive", "replay", "plot", "calibrate", "bringup", "ports", "pins", "doctor", "jitter",
        "sim", "sensors", "budget", "send", "encode", "decode"}) {
    Command help{{command, "--help"}};
    ASSERT_EQ(help.exit_code(), 0);
    std::istringstream lines{help.out()};
    std::string option;
    for (std::string line; std::getline(lines, line);) {
      const std::size_t at = line.find("--");
      if (line.starts_with("  -") && at != std::string::npos)
        option = line.substr(at, line.find_first_of(" ,=[", at) - at);
      const bool names = line.find(" file") != std::string::npos ||
                         line.find("PREFIX") != std::string::npos ||
                         line.find("SVG") != std::string::npos;
      if (!names || option.empty() || std::ranges::find(others, option) != others.end()) continue;
      const auto is_it = [&](const NamedFile& named) {
        return named.command.front() == command && named.option == option;
      };
      EXPECT_TRUE(std::ranges::any_of(kOutputs, is_it) || std::ranges::any_of(kInputs, is_it))
          << command << " " << option << ": " << line;
    }
  }
}

class OneFileTwiceTest : public DriveTest {
 protected:
  OneFileTwiceTest() {
    (void)folder_.write("there", "1 100 100\n");
    fs::create_symlink("there", folder_.path("link"));
    fs::create_hard_link(folder_.path("there"), folder_.path("hard"));
    (void)folder_.write("config.toml", "baud = 57600\n");
    (void)folder_.write("world", "wall 0 0 1000 0\n");
    fs::create_directory(folder_.path("folder"));
  }
  void expect_refused(const Words& command, const char* says) const {
    Command refused{command};
    EXPECT_EQ(refused.exit_code(), 1) << says;
    EXPECT_THAT(refused.err(), OneErrorLine(says));
    EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
    EXPECT_EQ(contents(folder_.path("there")), "1 100 100\n");
    EXPECT_EQ(contents(folder_.path("config.toml")), "baud = 57600\n");
  }
  std::string file(const char* name) const { return folder_.path(name); }

  const TemporaryFolder folder_;
};

TEST_F(OneFileTwiceTest, IsRefusedAmongOutputs) {
  const char* const kSays = "the file of --record; name another file";
  expect_refused(drive({"--record", file("x"), "--plot", file("x")}), kSays);
  expect_refused(drive({"--record", file("x"), "--json", file("folder/../x")}), kSays);
  expect_refused(drive({"--record", file("there"), "--json", file("link")}), kSays);
  expect_refused(drive({"--record", file("there"), "--json", file("hard")}), kSays);
  expect_refused({"jitter", "--json", file("x"), "--plot", file("x")}, "the file of --json");
  expect_refused({"jitter", "--json", file("x-echo.hgrm"), "--hgrm", file("x")}, "--json");
  expect_refused({"jitter", "--json", "-", "--plot", "-"}, "names standard output, the file of");
  expect_refused({"calibrate", "--json", file("x"), "--write", file("x")}, "the file of --write");
  EXPECT_FALSE(fs::exists(file("x")));
}

TEST_F(OneFileTwiceTest, IsRefusedWhereItIsRead) {
  expect_refused(drive({"--profile", file("there"), "--json", file("hard")}), "the profile");
  expect_refused(drive({"--config", file("config.toml"), "--plot", file("config.toml")}),
                 "the configuration");
  expect_refused({"calibrate", "--config", file("config.toml"), "--json", file("config.toml")},
                 "the configuration");
  expect_refused({"bringup", "--config", file("config.toml"), "--json", file("config.toml")},
                 "the configuration");
  expect_refused({"jitter", "--config", file("config.toml"), "--json", file("config.toml")},
                 "the configuration");
  expect_refused({"plot", file("there"), "-o", file("link")}, "the recording");
  expect_refused({"replay", file("there"), "--json", file("there")}, "the recording");
  expect_refused({"jitter", "compare", file("there"), file("link"), "--plot", file("hard")},
                 "a file to be compared");
  expect_refused({"sim", "--world", file("world"), "--trace", file("world")}, "the world");
  expect_refused({"sim", "--link", file("x"), "--trace", file("x")}, "the place of --link");
  expect_refused({"sim", "--control", file("x"), "--trace", file("x")}, "the place of --control");
}

TEST_F(OneFileTwiceTest, MayBeNull) {
  Command command{drive({"--duration", "0.3", "--record", "/dev/null", "--json", "/dev/null",
                         "--plot", "/dev/null"})};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
}

TEST_F(OneFileTwiceTest, IsEditedWhereThatIsTheWish) {
  Command command{{"calibrate", "--port", port_, "--config", file("config.toml"), "--write",
                   file("config.toml")}};
  EXPECT_TRUE(eventually([&command] {
    return !command.running() || command.err().find("keep the floor clear") != std::string::npos;
  }));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT) << command.err();
  EXPECT_EQ(contents(file("config.toml")), "baud = 57600\n");
}

TEST_F(OneFileTwiceTest, IsRefusedWhereThePortIsStandardOutput) {
  Command command{{"sensors", "--port", "/dev/fd/1"}, kOnTerminal};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("is also where this command prints"));
}

// A plain name among other files.
TEST_F(OneFileTwiceTest, LeavesWhatLiesBesideIt) {
  fs::create_symlink(file("there"), file("x.part"));
  Command command{drive({"--duration", "0.3", "--json", file("x")})};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(contents(file("there")), "1 100 100\n");
  EXPECT_THAT(contents(file("x")), Not(IsEmpty()));
}

}  // namespace
}  // namespace cargobay::test
