// What `cargobay drive` reports: table, status line, JSON and plot.

#include <algorithm>
#include <cctype>

#include <nlohmann/json.hpp>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using hal::sim::Device;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// A number for each of these names, and nothing else.
void expect_numbers(const json& results, const char* key, const std::vector<std::string>& names) {
  ASSERT_TRUE(results.contains(key)) << key;
  const json& object = results.at(key);
  ASSERT_TRUE(object.is_object()) << key;
  EXPECT_EQ(object.size(), names.size()) << key;
  for (const std::string& name : names) {
    ASSERT_TRUE(object.contains(name)) << key << ' ' << name;
    EXPECT_TRUE(object.at(name).is_number()) << key << ' ' << name;
  }
}

void expect_common_keys(const json& results) {
  for (const char* key : {"port", "remainder", "scheduler"}) {
    ASSERT_TRUE(results.contains(key)) << key;
    EXPECT_TRUE(results.at(key).is_string()) << key;
  }
  for (const char* key :
       {"baud", "priority", "ticks", "frames_good", "frames_bad", "frames_lost"}) {
    ASSERT_TRUE(results.contains(key)) << key;
    EXPECT_TRUE(results.at(key).is_number_integer()) << key;
  }
  expect_numbers(results, "steady_error_mm_s", {"left", "right"});
  expect_numbers(results, "tracking_rmse_mm_s", {"left", "right"});
  expect_numbers(results, "period_ns", {"p50", "p99", "max"});
  expect_numbers(results, "frame_to_command_ns", {"p50", "p99", "p999", "max"});
}

void expect_ascending(const json& object, const std::vector<std::string>& names) {
  for (std::size_t i = 1; i < names.size(); ++i)
    EXPECT_LE(object.at(names[i - 1]), object.at(names[i])) << object;
}

// Elements closed in order, attributes quoted, nothing left unescaped: as much of XML as a plot
// needs. Returns what is wrong.
std::string flaw(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < xml.size();) {
    if (xml[at] != '<') {
      if (xml[at] == '>') return "a stray >";
      if (xml[at] == '&' && xml.find(';', at) > at + 5) return "a stray &";
      if (open.empty() && std::isspace(static_cast<unsigned char>(xml[at])) == 0)
        return "text outside of the root";
      ++at;
      continue;
    }
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return "an open tag";
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos) return "a tag in a tag: " + tag;
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return "an open quote: " + tag;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (name.starts_with('/')) {
      if (open.empty() || "/" + open.back() != name) return "closed but not open: " + name;
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(name);
    }
    at = end + 1;
  }
  return open.empty() ? "" : "open at the end: " + open.back();
}

// How many lines of a plot have this label.
std::ptrdiff_t labels(const std::string& svg, const std::string& label) {
  std::ptrdiff_t count = 0;
  const std::string text = ">" + label + "</text>";
  for (std::size_t at = svg.find(text); at != std::string::npos; at = svg.find(text, at + 1))
    ++count;
  return count;
}

TEST(DriveResults, HoldTheKeysOfTheJson) {
  Command command{{"drive", "--duration", "2", "--json", "-"}};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.err(), IsEmpty());
  const json results = json::parse(command.out(), nullptr, false);
  ASSERT_TRUE(results.is_object()) << command.out();
  expect_common_keys(results);
  expect_numbers(results, "estimate_rmse_mm_s", {"left", "right"});
  EXPECT_EQ(results.at("reconnects"), 0);
  EXPECT_GE(results.at("findings").size(), 6U) << "what cargobay doctor says";
  EXPECT_TRUE(results.at("findings").at(0).contains("remedy"));
  EXPECT_THAT(results.at("port"), StartsWith("/dev/"));
  EXPECT_EQ(results.at("baud"), 57600);
  EXPECT_EQ(results.at("remainder"), "carried") << "two seconds are enough to find out";
  const bool fifo = results.at("scheduler") == "SCHED_FIFO";
  EXPECT_TRUE(fifo || results.at("scheduler") == "SCHED_OTHER");
  EXPECT_EQ(results.at("priority"), fifo ? 80 : 0);
  EXPECT_GE(results.at("ticks"), 133) << "2 s of 15 ms";
  EXPECT_GT(results.at("frames_good"), 0);
  expect_ascending(results.at("period_ns"), {"p50", "p99", "max"});
  expect_ascending(results.at("frame_to_command_ns"), {"p50", "p99", "p999", "max"});
}

TEST(DriveResults, SayWhatWasLearntAndTheNextDriveBeginsFromIt) {
  const TemporaryFolder folder;
  const std::string file = folder.path("it.toml");
  const auto learnt_with = [](const char* duration_s, const std::vector<std::string>& more) {
    std::vector<std::string> words{"drive", "--duration", duration_s, "--profile",
                                   "steps", "--json",     "-"};
    words.insert(words.end(), more.begin(), more.end());
    Command command{words};
    EXPECT_EQ(command.exit_code(), 0) << command.err();
    EXPECT_THAT(command.err(), IsEmpty());
    return json::parse(command.out(), nullptr, false).at("learnt");
  };
  const json first = learnt_with("4", {"--learnt", file});
  EXPECT_NEAR(first.at("gain_left"), 0.94, 0.05);
  EXPECT_NEAR(first.at("lag_s"), 0.1, 0.05);
  EXPECT_GT(first.at("gain_right_sd"), 0.0);
  EXPECT_EQ(first.at("file"), file);
  EXPECT_FALSE(first.at("began_from_earlier"));
  EXPECT_TRUE(learnt_with("0.5", {"--learnt", file}).at("began_from_earlier"));
  EXPECT_FALSE(learnt_with("0.5", {"--learnt", file, "--forget"}).at("began_from_earlier"));
  EXPECT_FALSE(learnt_with("0.5", {"--learnt", "none"}).at("began_from_earlier"));
  EXPECT_TRUE(learnt_with("0.5", {}).at("file").is_null()) << "of a virtual Create nothing is kept";
}

TEST_F(DriveTest, SaysThatItCannotKeepWhatItLearns) {
  Command command{drive({"--duration", "5", "--learnt", "/dev/full"})};
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_THAT(command.err(), testing::HasSubstr("is not kept: cannot write /dev/full"));
}

TEST_F(DriveTest, KnowsNoTruthAboutARobotThatIsNotItsOwn) {
  Command command{drive({"--duration", "2", "--json", "-"})};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  const json results = json::parse(command.out(), nullptr, false);
  ASSERT_TRUE(results.is_object()) << command.out();
  expect_common_keys(results);
  EXPECT_EQ(results.at("port"), port_);
  EXPECT_FALSE(results.contains("estimate_rmse_mm_s"));
}

TEST_F(DriveTest, SaysInJsonWhichBumperItWas) {
  server_->with_device([](Device& device) { device.inputs().bump_left = true; });
  Command command{drive({"--duration", "1", "--json", "-"})};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  const json results = json::parse(command.out(), nullptr, false);
  ASSERT_TRUE(results.is_object()) << command.out();
  const json& events = results.at("events");
  const auto bump = std::find_if(events.begin(), events.end(), [](const json& event) {
    return event.at("what") == "bump_began";
  });
  ASSERT_NE(bump, events.end()) << events;
  EXPECT_EQ(bump->at("bumps"), json::array({"bump_left"}));
}

TEST_F(DriveTest, WritesJsonAndPlotBesideTheTable) {
  const TemporaryFolder folder;
  const std::string file = folder.write("results.json", "of yesterday");
  Command command{{"drive", "--duration", "1", "--profile", "spin", "--json", file, "--plot",
                   folder.path("plot.svg")}};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), AllOf(HasSubstr("Wheel speed"), HasSubstr("Frames")));
  EXPECT_TRUE(json::parse(contents(file), nullptr, false).is_object()) << contents(file);

  const std::string svg = contents(folder.path("plot.svg"));
  EXPECT_EQ(flaw(svg), "");
  EXPECT_THAT(svg, StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  for (const char* label : {"set speed", "true speed", "estimate", "command"})
    EXPECT_EQ(labels(svg, label), 2) << label << ": one a wheel";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path("")}, {}), 2)
      << "nothing is left beside the two";
}

TEST_F(DriveTest, PlotsNoTruthOfARobotThatIsNotItsOwn) {
  const TemporaryFolder folder;
  const std::string profile = folder.write("a<b & \"c\"", "0.5 200 100\n# then turn\n0.5 0 100\n");
  Command command{
      drive({"--duration", "1", "--profile", profile, "--plot", folder.path("plot.svg")})};
  ASSERT_EQ(command.exit_code(), 0) << command.err();
  const std::string svg = contents(folder.path("plot.svg"));
  EXPECT_EQ(flaw(svg), "") << "whatever the profile is called";
  EXPECT_EQ(labels(svg, "true speed"), 0);
  for (const char* label : {"set speed", "estimate", "command"}) EXPECT_EQ(labels(svg, label), 2);
}

TEST(DriveResults, FlawFindsWhatIsWrongWithAPlot) {
  EXPECT_EQ(flaw("<a x=\"1\"><b/>t &amp; t</a>\n"), "");
  for (const char* bad :
       {"<a>", "<a><b></a>", "</a>", "<a x=\"1></a>", "<a>&</a>", "<a/>text", "<a", "<a> > </a>"})
    EXPECT_NE(flaw(bad), "") << bad;
}

TEST_F(DriveTest, ShowsNoStatusLineWithoutATerminal) {
  Command command{drive({"--duration", "0.6"})};
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_THAT(command.out(),
              AllOf(HasSubstr("Wheel speed"), Not(HasSubstr("\r")), Not(HasSubstr("\033"))));
  EXPECT_THAT(command.err(), IsEmpty());
}

}  // namespace
}  // namespace cargobay::test
