// What the command says to words that it does not know, and what it offers to a shell.

#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drive_fixture.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/fault_command.hpp"
#include "oi/command_table.hpp"
#include "oi/extensions.hpp"
#include "oi/packet_table.hpp"
#include "tests/pty/tools_process.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using CommandLine = std::vector<std::string>;

struct Mistyped {
  CommandLine words;
  const char* says;
};

TEST(Usage, NamesWhatWasMeantAndTheHelpForIt) {
  for (const Mistyped& row : std::initializer_list<Mistyped>{
           {{"drvie"},
            "'drvie' is not a command; did you mean 'drive'? see: cargobay drive --help"},
           {{"snesors"}, "did you mean 'sensors'?"},
           {{"sens"}, "did you mean 'sensors'?"},
           {{"record", "--help"}, "a drive is recorded with: cargobay drive --record FILE"},
           {{"stop"}, "cargobay send --port PORT stop"},
           {{"dock"}, "cargobay send"},
           {{"list"}, "cargobay ports"},
           {{"drive_direct", "100", "100"}, "one of the robot's; see: cargobay send --help"},
           {{"xyzzy"}, "'xyzzy' is not a command; see: cargobay --help"},
           {{}, "which command? see: cargobay --help"},
           {{"Drive"}, "'Drive' is not a command; did you mean 'drive'?"},
           {{"SEND", "stop"}, "did you mean 'send'?"},
           {{"soft_reset"}, "one of the robot's; see: cargobay send --help"},
           {{"--halp"}, "cargobay has no option --halp; did you mean --help?"},
           {{"--verison"}, "did you mean --version?"},
           {{"-V"}, "did you mean --version?"},
           {{"--port", "/dev/null", "drive"},
            "options follow the command: cargobay COMMAND --port"},
           {{"drive", "--seped", "3"},
            "cargobay drive has no option --seped; did you mean --speed? see: cargobay drive "
            "--help"},
           {{"drive", "--duraton=3"}, "no option --duraton; did you mean --duration?"},
           {{"sensors", "-p", "/dev/null"}, "no option -p; did you mean --port?"},
           {{"bringup", "--baudrate", "19200"}, "did you mean --baud?"},
           {{"drive", "--no-gaurd"}, "did you mean --no-guard?"},
           {{"send", "--bogus", "stop"}, "cargobay send has no option --bogus; see: cargobay send"},
           {{"send", "--lisen", "3", "stop"}, "did you mean --listen?"},
           {{"jitter", "compar"}, "did you mean 'compare'? see: cargobay jitter --help"},
           {{"jitter", "compare", "--plto", "x"},
            "did you mean --plot? see: cargobay jitter compare"},
           {{"ports", "--", "usb"}, "cargobay ports takes no 'usb'; see: cargobay ports --help"},
           {{"drive", "fast"}, "cargobay drive takes no 'fast'; see: cargobay drive --help"},
           {{"drive", "--speed"}, "see: cargobay drive --help"},
           {{"sim", "--count", "many"}, "see: cargobay sim --help"}}) {
    const Outcome outcome = run_tool(row.words);
    EXPECT_EQ(outcome.code, 2) << row.says;
    EXPECT_EQ(outcome.out, "") << row.says;
    EXPECT_THAT(outcome.error, OneErrorLine(row.says));
  }
}

TEST(Usage, DoesNotGuessWhatMovesARobotOrTakesItsGuard) {
  for (const CommandLine& words : std::initializer_list<CommandLine>{{"dive_in"},
                                                                     {"rive"},
                                                                     {"live"},
                                                                     {"end"},
                                                                     {"sand"},
                                                                     {"mend"},
                                                                     {"bend"},
                                                                     {"sendme"},
                                                                     {"recalibrate"},
                                                                     {"drive", "--guard"},
                                                                     {"send", "--keep-running"},
                                                                     {"drive", "--fool"}}) {
    const Outcome outcome = run_tool(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.error, Not(HasSubstr("did you mean 'drive'"))) << words.back();
    EXPECT_THAT(outcome.error, Not(HasSubstr("did you mean 'send'"))) << words.back();
    EXPECT_THAT(outcome.error, Not(HasSubstr("did you mean 'calibrate'"))) << words.back();
    EXPECT_THAT(outcome.error, Not(HasSubstr("--no-guard"))) << words.back();
    EXPECT_THAT(outcome.error, Not(HasSubstr("--leave-running"))) << words.back();
    EXPECT_THAT(outcome.error, Not(HasSubstr("--full"))) << words.back();
  }
}

TEST(Usage, GivesHelpInBothSpellings) {
  EXPECT_EQ(run_tool({"help", "drive"}).out, run_tool({"drive", "--help"}).out);
  EXPECT_EQ(run_tool({"help"}).out, run_tool({"--help"}).out);
  EXPECT_EQ(run_tool({"help", "jitter", "compare"}).out,
            run_tool({"jitter", "compare", "--help"}).out);
}

class StopWordTest : public DriveTest {};

TEST_F(StopWordTest, StopsTheWheelsOfARobot) {
  Command command{{"send", "--port", port_, "start; safe; drive 100 straight; stop"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_EQ(command.err(), "");  // nothing turns, so nothing waits for Ctrl-C
  EXPECT_TRUE(stands_still());
  EXPECT_EQ(mode(), oi::Mode::safe);
}

TEST_F(StopWordTest, EndsADemoInPassiveModeAndSaysSo) {
  Command command{{"send", "--port", port_, "start; stop"}};
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_THAT(command.err(), HasSubstr("if it ran a demo, that was ended"));
  EXPECT_THAT(command.err(), Not(HasSubstr("safe;")));
}

TEST_F(StopWordTest, IsNeverAnsweredByACommandThatDrives) {
  for (const char* const text : {"start; safe; drive 100 straight; stop", "start; safe; spin",
                                 "start; safe; power", "start; safe; wake"}) {
    Command command{{"send", "--port", port_, text}};
    command.exit_code();
    EXPECT_THAT(command.err(), Not(HasSubstr("did you mean"))) << text;
  }
  EXPECT_TRUE(stands_still());
}

// The words of `cargobay complete ...`.
std::set<std::string> offered(CommandLine words) {
  words.insert(words.begin(), "complete");
  std::set<std::string> all;
  std::istringstream lines{run_tool(words).out};
  for (std::string line; std::getline(lines, line);) all.insert(line.substr(0, line.find('\t')));
  return all;
}
template <typename Table, typename Name>
std::set<std::string> names_in(const Table& table, Name&& name) {
  std::set<std::string> all;
  for (const auto& row : table) all.emplace(name(row));
  return all;
}

TEST(Completion, OffersTheWordsOfTheTables) {
  const auto by_name = [](const auto& row) { return row.name; };
  const auto by_key = [](const auto& row) { return row.key; };
  EXPECT_EQ(offered({"sensors", "--packets", ""}), names_in(oi::kPackets, by_key));
  EXPECT_EQ(offered({"sim", "--fault", ""}), names_in(hal::sim::faults(), by_name));
  EXPECT_EQ(offered({"drive", "--plant", ""}), names_in(hal::sim::plants(), by_name));
  std::set<std::string> commands = names_in(oi::kCommands, by_key);
  commands.merge(names_in(oi::kExtensionCommands, [](const auto& row) { return row.info.key; }));
  commands.insert({"stop", "tune", "bytes"});
  EXPECT_EQ(offered({"send", ""}), commands);
  EXPECT_EQ(offered({"encode", "safe;", ""}), commands);
  // Each is a profile that drives.
  std::set<std::string> profiles = offered({"drive", "--profile", ""});
  EXPECT_EQ(profiles.erase(":files"), 1U);
  EXPECT_EQ(profiles, (std::set<std::string>{"straight", "steps", "square", "spin"}));
}

// Every option of the help is offered, and nothing else.
TEST(Completion, OffersTheOptionsOfTheHelp) {
  for (const std::string& name : offered({""})) {
    std::set<std::string> in_help;
    std::istringstream help{run_tool({name, "--help"}).out};
    for (std::string line; std::getline(help, line);) {
      if (!line.starts_with("  -")) continue;
      const std::size_t begin = line.find("--");
      if (begin != std::string::npos) {
        in_help.insert(line.substr(begin, line.find_first_of(" {=[,", begin) - begin));
      }
    }
    EXPECT_GT(in_help.size(), 0U) << name;
    EXPECT_EQ(offered({name, "--"}), in_help) << name;
  }
}

TEST(Completion, KeepsWhatAValueIsJoinedTo) {
  EXPECT_EQ(offered({"drive", "--remainder=l"}), std::set<std::string>{"--remainder=lost"});
  EXPECT_EQ(offered({"sensors", "--packets", "wall,angl"}), std::set<std::string>{"wall,angle"});
  EXPECT_EQ(offered({"sensors", "--packets=wall,angl"}),
            std::set<std::string>{"--packets=wall,angle"});
  EXPECT_EQ(offered({"send", "stream", "distance", "ang"}), std::set<std::string>{"angle"});
  EXPECT_EQ(offered({"drive", "--duration", ""}), std::set<std::string>{});
  EXPECT_EQ(offered({"nonsense", "--po"}), std::set<std::string>{});
  EXPECT_EQ(offered({"bringup", "--brc-line", "r"}), std::set<std::string>{"rts"});
  EXPECT_EQ(offered({"help", "dri"}), std::set<std::string>{"drive"});
  EXPECT_EQ(run_tool({"complete"}).code, 0);
}

// JSON for programs: an array, whatever this machine has.
TEST(MachineLists, AreJson) {
  for (const char* const name : {"ports", "pins"}) {
    const Outcome outcome = run_tool({name, "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_TRUE(outcome.out.starts_with("[")) << name;
    EXPECT_TRUE(outcome.out.ends_with("]\n")) << name;
  }
  EXPECT_EQ(run_tool({"pins", "--json", "--watch", "4"}).code, 2);
}

}  // namespace
}  // namespace cargobay::test
