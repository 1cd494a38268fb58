// `cargobay jitter`: it measures what really happened, however it ends, and its files hold what
// they claim.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pty/drive_fixture.hpp"

namespace cargobay::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

// Runs it with these further arguments; returns the result as JSON.
json measured(std::vector<std::string> more) {
  std::vector<std::string> arguments{"jitter", "--json", "-"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Command command{std::move(arguments)};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  return json::parse(command.out());
}

std::uint64_t counted_from(const json& histogram, std::uint64_t least_ns) {
  std::uint64_t count = 0;
  for (const json& bucket : histogram) {
    if (bucket.at(0).get<std::uint64_t>() >= least_ns) count += bucket.at(1).get<std::uint64_t>();
  }
  return count;
}

class JitterHoldTest : public testing::TestWithParam<const char*> {};

// Every tenth of two slices of 33 frames is 40 ms late, and so is one that would have waited after
// it, by 15 ms less; the next, 10 ms late, is within a period.
TEST_P(JitterHoldTest, ShowsWhatWasHeldBack) {
  const json result = measured({"--channels", GetParam(), "--period", "15", "--frames", "66",
                                "--warm-up", "0", "--hold-every", "10", "--hold", "40"});
  const json& channel = result.at("channels").at(0);
  EXPECT_EQ(channel.at("name"), GetParam());
  const json& raw = channel.at("uncorrected_histogram_ns");
  const json& corrected = channel.at("histogram_ns");
  EXPECT_EQ(counted_from(raw, 40'000'000), 6U);
  EXPECT_EQ(counted_from(corrected, 40'000'000), 6U);
  EXPECT_GE(channel.at("latency_ns").at("max"), 40'000'000U);
  EXPECT_EQ(channel.at("latency_ns").at("min"), channel.at("uncorrected_ns").at("min"));
  EXPECT_EQ(counted_from(corrected, 25'000'000), counted_from(raw, 25'000'000) + 6U);
  EXPECT_EQ(counted_from(corrected, 0), counted_from(raw, 0) + 6U);
}

INSTANTIATE_TEST_SUITE_P(Each, JitterHoldTest, testing::Values("echo", "loop"),
                         [](const auto& tested) { return std::string{tested.param}; });

// 33 frames of the robot: whichever comes first, every eleventh makes three of them. 10 ms late,
// they still come before the next.
TEST(JitterCommand, ShowsWhatTheVirtualCreateHeldBack) {
  const json result = measured({"--channels", "robot", "--period", "15", "--frames", "33",
                                "--warm-up", "0", "--hold-every", "11", "--hold", "10"});
  const json& channel = result.at("channels").at(0);
  EXPECT_EQ(channel.at("frames"), 33U);
  EXPECT_EQ(counted_from(channel.at("uncorrected_histogram_ns"), 10'000'000), 3U);
}

TEST(JitterCommand, MeasuresEveryChannelInTurn) {
  const json result = measured({"--frames", "600"});
  std::vector<std::string> names;
  for (const json& channel : result.at("channels")) {
    names.push_back(channel.at("name"));
    EXPECT_GT(channel.at("frames"), 0U) << names.back();
    EXPECT_GE(channel.at("slices_p50_p99_ns").size(), 2U) << names.back();
    EXPECT_LE(channel.at("latency_ns").at("p50"), channel.at("latency_ns").at("p99"));
    EXPECT_EQ(channel.at("latency_ns").at("count"), counted_from(channel.at("histogram_ns"), 0));
  }
  EXPECT_THAT(names, testing::ElementsAre("robot", "loop", "echo", "again", "pipe", "sleep"));
  EXPECT_EQ(result.at("ratios").size(), 3U);
  // A frame wakes the loop before it is decided on, and that is before the command is written.
  const json& loop = result.at("channels").at(1).at("stages_ns");
  EXPECT_LE(loop.at("woken").at("p50"), loop.at("decided").at("p50"));
  EXPECT_LE(loop.at("decided").at("p50"), loop.at("written").at("p50"));
  // On the wire a command of five bytes takes 0.87 ms.
  const json& robot = result.at("channels").at(0).at("stages_ns");
  EXPECT_GE(robot.at("arrived").at("p50"), robot.at("written").at("p50").get<int>() + 800'000);
}

TEST(JitterCommand, MeasuresARobotAtAPortAndLeavesItStanding) {
  auto server = hal::sim::Server::open({}, {.priority = 70});
  ASSERT_TRUE(server);
  ASSERT_FALSE((*server)->start());
  const json result =
      measured({"--channels", "robot", "--duration", "1", "--port", (*server)->path()});
  EXPECT_GT(result.at("channels").at(0).at("frames"), 20U);
  EXPECT_FALSE(result.at("channels").at(0).at("stages_ns").contains("arrived"));
  const hal::sim::Snapshot robot = (*server)->snapshot();
  EXPECT_EQ(robot.mode, oi::Mode::passive);
  EXPECT_EQ(robot.commanded, hal::sim::WheelSpeeds{});
}

TEST(JitterCommand, TellsWhatItHasOnControlC) {
  Command command{{"jitter", "--duration", "600", "--channels", "echo,sleep"}};
  usleep(1'500'000);  // into the second round: there is nothing to wait for
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_THAT(command.out(),
              AllOf(StartsWith("Timing jitter, "), HasSubstr("\necho "), HasSubstr("\nsleep ")));
}

TEST(JitterCommand, SaysInItsHeadlineThatItHasNoRights) {
  Command command{{"jitter", "--channels", "pipe", "--duration", "1"},
                  {.user = Command::Setup::User::nobody}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), HasSubstr("WITHOUT real-time rights"));
}

TEST(JitterCommand, WritesTheFormatsOfOthers) {
  const TemporaryFolder folder;
  Command command{{"jitter", "--channels", "echo,pipe", "--frames", "500", "--hgrm",
                   folder.path("run"), "--cyclictest", folder.path("hist"), "--plot",
                   folder.path("run.svg"), "--json", folder.path("run.json")}};
  ASSERT_EQ(command.exit_code(), 0) << command.err();

  const json channel = json::parse(contents(folder.path("run.json"))).at("channels").at(0);
  const std::string hgrm = contents(folder.path("run-echo.hgrm"));
  EXPECT_THAT(hgrm, StartsWith("       Value     Percentile TotalCount 1/(1-Percentile)\n\n"));
  EXPECT_THAT(hgrm, HasSubstr("1.000000000000 "));
  const std::size_t total = hgrm.find("Total count    = ");
  ASSERT_NE(total, std::string::npos);
  EXPECT_EQ(std::stoull(hgrm.substr(total + 17)), channel.at("latency_ns").at("count"));

  // As cyclictest -h 1000 --histfile or more writes it: every row, then its summary.
  std::istringstream hist{contents(folder.path("hist"))};
  std::string line;
  ASSERT_TRUE(std::getline(hist, line));
  EXPECT_EQ(line, "# Histogram");
  std::uint64_t echo = 0;
  for (std::uint64_t row = 0; std::getline(hist, line) && line[0] != '#'; ++row) {
    std::uint64_t us = 0;
    std::uint64_t first = 0;
    std::istringstream figures{line};
    ASSERT_TRUE(figures >> us >> first) << line;
    ASSERT_EQ(us, row);
    echo += first;
  }
  EXPECT_EQ(echo, channel.at("uncorrected_ns").at("count"));
  EXPECT_THAT(line, MatchesRegex("# Total: [0-9]{9} [0-9]{9}"));
  for (const char* begins :
       {"# Min Latencies: ", "# Avg Latencies: ", "# Max Latencies: ", "# Histogram Overflows: ",
        "# Histogram Overflow at cycle number:", "# Thread 0:", "# Thread 1:"}) {
    ASSERT_TRUE(std::getline(hist, line));
    EXPECT_THAT(line, StartsWith(begins));
  }
  ASSERT_TRUE(std::getline(hist, line));
  EXPECT_EQ(line, "") << "ends with an empty line";

  const std::string svg = contents(folder.path("run.svg"));
  EXPECT_THAT(svg, AllOf(StartsWith("<svg "), HasSubstr(">echo<"), HasSubstr(">pipe<")));
}

// "1.074 [0.9, 1.2]" after "p99 x ": the ratio.
double ratio_in(const std::string& line, const std::string& after) {
  const std::size_t at = line.find(after);
  EXPECT_NE(at, std::string::npos) << line;
  return at == std::string::npos ? 0.0 : std::stod(line.substr(at + after.size()));
}

void write_file(const std::string& path, const std::string& text) { std::ofstream{path} << text; }

json with_figures(json result, std::uint64_t p50, std::uint64_t p99) {
  json& channel = result.at("channels").at(0);
  channel.at("latency_ns").at("p50") = p50;
  channel.at("latency_ns").at("p99") = p99;
  channel.at("confidence").at("p50").at("value_ns") = p50;
  channel.at("confidence").at("p99").at("value_ns") = p99;
  return result;
}

// A case of a user's: 1097.7 and 1196.0 us were said to differ by a factor of 0.51, because the
// ratio was that of other figures than those shown.
TEST(JitterCommand, ComparesWhatItShows) {
  const TemporaryFolder folder;
  const json result = measured({"--channels", "pipe", "--frames", "1500"});
  write_file(folder.path("a.json"), with_figures(result, 24'100, 1'097'700).dump());
  write_file(folder.path("b.json"), with_figures(result, 31'300, 1'196'000).dump());
  Command command{{"jitter", "compare", folder.path("a.json"), folder.path("b.json"), "--plot",
                   folder.path("both.svg")}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_NEAR(ratio_in(command.out(), "p50 x "), 31.3 / 24.1, 0.0006);
  EXPECT_NEAR(ratio_in(command.out(), "p99 x "), 1196.0 / 1097.7, 0.0006);
  EXPECT_THAT(command.out(), HasSubstr("\n[none] at p99: fewer than 30 slices (pipe "));
  EXPECT_THAT(command.out(), Not(HasSubstr("Different")));
  EXPECT_THAT(contents(folder.path("both.svg")), HasSubstr("a.json"));
}

// Of the channel pipe in a table, in microseconds.
struct Row {
  double p50 = 0.0;
  double p99 = 0.0;
};
Row row_in(const std::string& table) {
  const std::string begins = "\npipe   frame to answer written ";
  const std::size_t at = table.find(begins);
  EXPECT_NE(at, std::string::npos) << table;
  std::istringstream figures{table.substr(std::min(at, table.size() - 1) + begins.size())};
  double frames = 0.0;
  double missed = 0.0;
  double least = 0.0;
  Row row;
  EXPECT_TRUE(figures >> frames >> missed >> least >> row.p50 >> row.p99) << table;
  return row;
}

// Figures are rounded to 0.1 us, ratios to 0.001.
void expect_ratio(double found, double over, double under) {
  EXPECT_GE(found, (over - 0.05) / (under + 0.05) - 0.0006);
  EXPECT_LE(found, (over + 0.05) / (under - 0.05) + 0.0006);
}

TEST(JitterCommand, ComparesTwoRunsAsTheirTablesDo) {
  const TemporaryFolder folder;
  std::array<Row, 2> rows{};
  for (std::size_t run = 0; run < rows.size(); ++run) {
    Command command{{"jitter", "--channels", "robot,pipe", "--frames", "600", "--json",
                     folder.path(std::to_string(run))}};
    ASSERT_EQ(command.exit_code(), 0) << command.err();
    rows[run] = row_in(command.out());
  }
  Command command{{"jitter", "compare", folder.path("0"), folder.path("1")}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  const std::string ratios = command.out().substr(command.out().find("\npipe "));
  expect_ratio(ratio_in(ratios, "p50 x "), rows[1].p50, rows[0].p50);
  expect_ratio(ratio_in(ratios, "p99 x "), rows[1].p99, rows[0].p99);
  EXPECT_THAT(ratios, Not(HasSubstr("Different: robot"))) << "both had a virtual Create";
}

TEST(JitterCommand, SaysInWhichConditionsResultsDiffer) {
  const TemporaryFolder folder;
  json result = measured({"--channels", "pipe", "--frames", "500"});
  result.at("conditions").at("load") = 0.1;
  write_file(folder.path("a.json"), result.dump());
  json& conditions = result.at("conditions");
  conditions.at("kernel") = "6.1.0-rt";
  conditions.at("governor") = "powersave";
  conditions.at("processor") = "Cortex-A53";
  conditions.at("load") = 3.5;
  result.at("load") = "stress-ng --cpu 0";
  result.at("settings") = {
      {"cpu", 7}, {"source_cpu", nullptr}, {"warm_up", 51}, {"hold_every", 10}, {"hold_ms", 20.0}};
  write_file(folder.path("b.json"), result.dump());
  Command command{{"jitter", "compare", folder.path("a.json"), folder.path("b.json")}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  for (const char* said :
       {"Different: kernel: ", "6.1.0-rt in ", "Different: governor: ", "powersave in ",
        "Different: processor: ", "Cortex-A53 in ", "Different: load asked for: none in ",
        "stress-ng --cpu 0 in ", "Different: load average: 0.10 in ", "3.50 in ",
        "Different: CPU: ", "7, far end any in ", "Different: warm-up: 50 frames in ",
        "Different: on purpose: none in ", "1 frame in 10 held back for 20 ms in "})
    EXPECT_THAT(command.out(), HasSubstr(said));
}

// What older versions wrote is compared without intervals, and named.
TEST(JitterCommand, ReadsResultsOfTheFirstFormat) {
  const TemporaryFolder folder;
  json result = measured({"--channels", "pipe", "--frames", "500"});
  write_file(folder.path("new.json"), result.dump());
  result.at("cargobay_jitter") = 1;
  result.erase("settings");
  result.at("channels").at(0).erase("confidence");
  write_file(folder.path("old.json"), result.dump());
  Command command{{"jitter", "compare", folder.path("old.json"), folder.path("new.json")}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), AllOf(HasSubstr("[none]"), HasSubstr("Different: correction: ")));
}

// What it takes to have intervals, of the channels whose ratios are shown. A frame of the robot
// takes as long as 15 others: its p99 would need half an hour.
TEST(JitterCommand, SaysHowLongToMeasureForIntervals) {
  Command command{{"jitter", "--channels", "robot,loop,echo", "--duration", "1", "--hold-every",
                   "10", "--hold", "0.1"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  const std::string out = command.out();
  EXPECT_THAT(out, HasSubstr(", 1 frame in 10 held back for 0.1 ms, "));
  for (const char* percentile : {"p50", "p99"}) {
    const std::string begins = std::string{"\n[none] at "} + percentile +
                               ": fewer than 30 slices (loop, echo); try --duration ";
    const std::size_t at = out.find(begins);
    ASSERT_NE(at, std::string::npos) << out;
    const double seconds = std::stod(out.substr(at + begins.size()));
    EXPECT_GE(seconds, 45.0) << "30 slices of three channels, 0.55 s each";
    EXPECT_LE(seconds, 600.0);
  }
}

struct Wrong {
  const char* name;
  std::vector<std::string> arguments;
  int code;
  const char* says;
};

class JitterBadInputTest : public testing::TestWithParam<Wrong> {};

TEST_P(JitterBadInputTest, IsOneLineThatSaysWhatToDo) {
  Command command{GetParam().arguments};
  EXPECT_EQ(command.exit_code(), GetParam().code);
  EXPECT_THAT(command.err(), OneErrorLine(GetParam().says));
  EXPECT_THAT(command.out(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Each, JitterBadInputTest,
    testing::Values(
        Wrong{"Channel", {"jitter", "--channels", "tea"}, 2, "tea"},
        Wrong{"Period", {"jitter", "--period", "0.2"}, 2, "0.2"},
        Wrong{"NoSuchCpu", {"jitter", "--cpu", "999"}, 1, "taskset -cp $$"},
        Wrong{"Folder", {"jitter", "--json", "/nosuch/file"}, 1, "/nosuch/file"},
        Wrong{"Port", {"jitter", "--port", "/dev/nosuch", "--channels", "robot"}, 1, "/dev/nosuch"},
        Wrong{"NoFile", {"jitter", "compare", "/nosuch.json", "/nosuch.json"}, 1, "cannot read"},
        Wrong{"NoResult",
              {"jitter", "compare", "/etc/passwd", "/etc/passwd"},
              1,
              "is not a result of cargobay jitter"},
        Wrong{"OneFile", {"jitter", "compare", "/etc/passwd"}, 2, "FILE"}),
    [](const auto& tested) { return std::string{tested.param.name}; });

}  // namespace
}  // namespace cargobay::test
