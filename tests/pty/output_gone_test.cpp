// Commands whose output nothing reads any more, or cannot be written: they end, say so with exit
// status 1, and leave port and robot free.

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "drive_fixture.hpp"
#include "shell.hpp"

namespace cargobay::test {
namespace {

struct Endless {
  const char* name;
  std::vector<std::string> arguments;
  bool takes_port = true;
  const char* says = "cannot write to standard output: Broken pipe";
};

std::ostream& operator<<(std::ostream& out, const Endless& endless) { return out << endless.name; }

class GoneOutputTest : public DriveTest, public testing::WithParamInterface<Endless> {
 protected:
  std::vector<std::string> words() const {
    std::vector<std::string> words = GetParam().arguments;
    if (GetParam().takes_port) words.insert(words.begin() + 1, {"--port", port_});
    return words;
  }
  // Another command gets the port.
  void expect_free_port() const {
    Command next{{"sensors", "--once", "--port", port_}};
    EXPECT_EQ(next.exit_code(), 0) << next.err();
  }
};

// As in `cargobay ... | head -1`: what has nothing to print notices too.
TEST_P(GoneOutputTest, EndsTheCommand) {
  Command command{words()};
  if (GetParam().takes_port) {
    ASSERT_TRUE(eventually([this] { return server_->snapshot().device.bytes_received > 0; }));
  }
  command.close_output();
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), testing::HasSubstr(GetParam().says));
  EXPECT_TRUE(stands_still());
  expect_free_port();
}

// Each would run for an hour or for ever.
const Endless kEndless[]{
    {"Drive", {"drive", "--duration", "3600"}},
    {"DriveToItsJson", {"drive", "--duration", "3600", "--json", "-"}},
    {"Sensors", {"sensors", "--json"}},
    {"SendThatListens", {"send", "--listen", "3600", "start; stream distance"}},
    {"SendThatHoldsTheWheels", {"send", "start; safe; drive 100 straight"}},
    {"JitterOfTheRobot", {"jitter", "--channels", "robot", "--duration", "3600"}},
    {"Jitter", {"jitter", "--channels", "sleep", "--duration", "3600"}, false},
    {"Calibrate", {"calibrate"}, false},
    {"Sim", {"sim"}, false},
};

INSTANTIATE_TEST_SUITE_P(Each, GoneOutputTest, testing::ValuesIn(kEndless),
                         [](const auto& tested) { return std::string{tested.param.name}; });

TEST(GoneOutput, IsNotThatOfAReaderThatHasReadAll) {
  Command command{{"encode", "safe"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(command.out(), "83\n");
}

TEST(GoneOutput, EndsWhatWaitsForStandardInput) {
  const TemporaryFolder folder;
  for (const std::string name : {"encode", "decode", "decode --binary -"}) {
    const std::string status = folder.path("status");
    const std::string says = folder.path("says");
    std::string line = "sleep 60 | { " CARGOBAY_BINARY_DIR "/cargobay ";
    line.append(name).append(" 2> ").append(says).append("; echo $? > ").append(status);
    const Shell shell{line.append("; } | true")};
    EXPECT_TRUE(eventually([&] { return contents(status) == "1\n"; })) << name;
    EXPECT_THAT(contents(says), testing::HasSubstr("nothing reads standard output any more"));
    std::filesystem::remove(status);
  }
}

// At a port without a robot, the bring-up of each is what ends.
TEST(GoneOutput, EndsABringUp) {
  const int silent = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_TRUE(silent >= 0 && grantpt(silent) == 0 && unlockpt(silent) == 0);
  std::array<char, 64> port{};
  ASSERT_EQ(ptsname_r(silent, port.data(), port.size()), 0);
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"drive"}, {"bringup"}, {"jitter", "--channels", "robot"}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--port", port.data()});
    Command command{all};
    command.close_output();
    EXPECT_EQ(command.exit_code(), 1) << words[0];
    EXPECT_THAT(command.err(), OneErrorLine("cannot write to standard output: Broken pipe"))
        << words[0];
  }
  close(silent);
}

class FullOutputTest : public DriveTest {
 protected:
  static constexpr Setup kFull{.output = Setup::Output::full};
  static constexpr const char* kSays = "cannot write to standard output: No space left on device";
};

TEST_F(FullOutputTest, IsAnErrorOfEachCommandThatNeedsNoRobot) {
  const TemporaryFolder folder;
  const std::string recording = folder.path("a.rec");
  Command drive{{"drive", "--virtual", "--duration", "0.3", "--record", recording, "--json",
                 folder.path("a.json")}};
  ASSERT_EQ(drive.exit_code(), 0) << drive.err();
  const std::string jitter = folder.path("jitter.json");
  Command measured{{"jitter", "--channels", "sleep", "--duration", "1", "--json", jitter}};
  ASSERT_EQ(measured.exit_code(), 0) << measured.err();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"--help"},
           {"--version"},
           {"ports"},
           {"pins"},
           {"pins", "--json"},
           {"jitter", "compare", jitter, jitter},
           {"doctor"},
           {"budget"},
           {"complete", "d"},
           {"encode", "safe"},
           {"encode", "--binary", "safe"},
           {"decode", "83"},
           {"replay", recording},
           {"plot", recording, "-o", "-"},
           {"sim"},
           {"jitter", "--channels", "sleep", "--duration", "1"}}) {
    Command command{words, kFull};
    EXPECT_EQ(command.exit_code(), 1) << words[0];
    // Even if that is not the only reason: doctor may have findings.
    EXPECT_THAT(command.err(), testing::HasSubstr(kSays)) << words[0];
  }
}

TEST_F(FullOutputTest, IsAnErrorOfEachCommandWithARobot) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"drive", "--duration", "0.3", "--port"},
           {"bringup", "--port"},
           {"sensors", "--once", "--port"},
           {"sensors", "--json", "--port"},
           {"send", "start; sensors oi_mode", "--port"},
           {"send", "--listen", "3600", "start; stream distance", "--port"}}) {
    std::vector<std::string> with_port = words;
    with_port.push_back(port_);
    Command command{with_port, kFull};
    EXPECT_EQ(command.exit_code(), 1) << words[0];
    EXPECT_THAT(command.err(), testing::HasSubstr(kSays)) << words[0];
    EXPECT_TRUE(stands_still()) << words[0];
  }
}

TEST_F(FullOutputTest, IsAnErrorOfTheHelpOfEachSubcommand) {
  for (const char* const name :
       {"drive", "replay", "plot", "calibrate", "bringup", "ports", "pins", "doctor", "jitter",
        "sim", "sensors", "budget", "send", "encode", "decode"}) {
    Command command{{name, "--help"}, kFull};
    EXPECT_EQ(command.exit_code(), 1) << name;
    EXPECT_THAT(command.err(), OneErrorLine(kSays)) << name;
  }
}

}  // namespace
}  // namespace cargobay::test
