// `cargobay export`, and `drive --record` as MCAP, as a user runs them.

#include <csignal>
#include <sstream>

#include <nlohmann/json.hpp>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const std::string kMcapMagic{"\x89MCAP0\r\n", 8};

std::size_t lines_with(const std::string& text, const std::string& what) {
  std::istringstream in{text};
  std::size_t count = 0;
  for (std::string line; std::getline(in, line);) count += line.find(what) != std::string::npos;
  return count;
}

class ExportTest : public DriveTest {
 protected:
  // Records half a second.
  void record() {
    Command drives{drive({"--duration", "0.5", "--record", file_})};
    ASSERT_EQ(drives.exit_code(), 0) << drives.err();
  }

  const TemporaryFolder folder_;
  const std::string file_ = folder_.path("drive.rec");
  const std::string mcap_ = folder_.path("drive.mcap");
};

TEST_F(ExportTest, GoesFromDriveToAllFormatsAtOnce) {
  record();
  const std::string csv = folder_.path("drive.csv");
  const std::string lines = folder_.path("drive.jsonl");
  Command exports{{"export", file_, "--csv", csv, "--jsonl", lines, "--mcap", mcap_}};
  EXPECT_EQ(exports.exit_code(), 0) << exports.err();
  EXPECT_THAT(exports.err(), IsEmpty());
  EXPECT_THAT(exports.out(),
              AllOf(StartsWith("Exported "), HasSubstr(" states, "), HasSubstr(mcap_)));
  EXPECT_THAT(contents(csv), StartsWith("topic,unix_time_s,time_s,tick,"));
  const std::string text = contents(lines);
  EXPECT_GT(lines_with(text, R"({"topic":"states")"), 20U);
  EXPECT_EQ(lines_with(text, R"("x_mm":)"), lines_with(text, R"({"topic":"states")"));
  EXPECT_GT(lines_with(text, R"("command":"drive_direct )"), 20U);
  EXPECT_EQ(lines_with(contents(csv), ""), lines_with(text, "") + 1);
  EXPECT_THAT(contents(mcap_), AllOf(StartsWith(kMcapMagic), EndsWith(kMcapMagic)));
}

TEST_F(ExportTest, WritesToStandardOutputAndNothingElse) {
  record();
  Command exports{{"export", file_, "--jsonl", "-", "--topics", "states"}};
  EXPECT_EQ(exports.exit_code(), 0) << exports.err();
  std::istringstream in{exports.out()};
  std::int64_t tick = 0;
  for (std::string line; std::getline(in, line); ++tick) {
    const json state = json::parse(line, nullptr, false);
    ASSERT_TRUE(state.is_object()) << line;
    EXPECT_EQ(state.at("topic"), "states");
  }
  EXPECT_GT(tick, 20);
}

TEST_F(ExportTest, ReadsARecordingThatWasNotFinished) {
  record();
  std::string bytes = contents(file_);
  bytes.resize(bytes.size() - 5);
  const std::string cut = folder_.write("cut.rec", bytes);
  Command exports{{"export", cut, "--jsonl", "-"}};
  EXPECT_EQ(exports.exit_code(), 0);
  EXPECT_THAT(exports.err(), HasSubstr("was not finished"));
  EXPECT_GT(lines_with(exports.out(), "states"), 20U);
}

TEST_F(ExportTest, EndsWhenNothingTakesWhatItWrites) {
  record();
  Command full{{"export", file_, "--csv", "-"}, {.output = Setup::Output::full}};
  EXPECT_EQ(full.exit_code(), 1);
  EXPECT_THAT(full.err(), OneErrorLine("cannot write to standard output: No space left"));
  Command device{{"export", file_, "--mcap", "/dev/full"}};
  EXPECT_EQ(device.exit_code(), 1);
  EXPECT_THAT(device.err(), OneErrorLine("cannot write /dev/full: No space left"));
}

TEST_F(ExportTest, LeavesNoHalfFile) {
  record();
  const std::string csv = folder_.write("drive.csv", "mine");
  Command limited{{"export", file_, "--csv", csv}, {.most_file_bytes = 8192}};
  EXPECT_EQ(limited.exit_code(), 1);
  EXPECT_THAT(limited.err(), OneErrorLine("File too large"));
  EXPECT_EQ(contents(csv), "mine");
}

TEST_F(ExportTest, RefusesWhatMakesNoSense) {
  record();
  const std::string before = contents(file_);
  struct Case {
    std::vector<std::string> words;
    int code;
    const char* says;
  };
  const std::string text = folder_.write("notes.txt", "no recording\n");
  for (const Case& each :
       {Case{{file_}, 2, "--csv FILE, --jsonl FILE or --mcap FILE is required"},
        Case{{file_, "--csv", "x", "--topics", "poses"}, 2, "poses not in {states,sensors"},
        Case{{file_, "--csv", file_}, 1, "the recording; name another file"},
        Case{{file_, "--csv", "-", "--jsonl", "-"}, 1, "the file of --csv"},
        Case{{text, "--csv", "-"}, 1, "notes.txt is not a recording of a drive"},
        Case{{folder_.path("no.rec"), "--csv", "-"}, 1, "no.rec: No such file"}}) {
    std::vector<std::string> words = each.words;
    words.insert(words.begin(), "export");
    Command command{words};
    EXPECT_EQ(command.exit_code(), each.code);
    EXPECT_THAT(command.err(), OneErrorLine(each.says));
    EXPECT_THAT(command.out(), IsEmpty());
  }
  EXPECT_EQ(contents(file_), before);
  Command terminal{{"export", file_, "--mcap", "-"}, kOnTerminal};
  EXPECT_EQ(terminal.exit_code(), 1);
}

TEST_F(ExportTest, RecordsMcapWhileItDrives) {
  Command drives{drive({"--duration", "1", "--record", mcap_})};
  ASSERT_EQ(drives.exit_code(), 0) << drives.err();
  EXPECT_THAT(drives.out(), HasSubstr("Recording  " + mcap_ + "; open it in Foxglove\n"));
  const std::string file = contents(mcap_);
  EXPECT_THAT(file, AllOf(StartsWith(kMcapMagic), EndsWith(kMcapMagic),
                          HasSubstr("straight at 200 mm/s, closed loop"),
                          HasSubstr(R"("command":"drive_direct 0 0")")));
  // The whole state of every tick, as the loop had it.
  const std::size_t states = [&] {
    std::size_t count = 0;
    for (std::size_t at = 0;
         (at = file.find(R"("covariance":{"xx_mm2")", at)) != std::string::npos;)
      ++at, ++count;
    return count;
  }();
  EXPECT_GT(states, 50U);
}

// It has 1.5 s for that, however long it drove.
TEST_F(ExportTest, FinishesTheMcapOfADriveThatASignalEnds) {
  Command command{drive({"--duration", "60", "--record", mcap_})};
  ASSERT_TRUE(starts_to_move());
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_THAT(contents(mcap_), AllOf(StartsWith(kMcapMagic), EndsWith(kMcapMagic)));
}

// The drive goes on.
TEST_F(ExportTest, SaysThatTheDiskWasTooSmallForTheMcap) {
  Command command{drive({"--duration", "1", "--record", mcap_}), {.most_file_bytes = 50000}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("File too large; raise the file size limit"));
  EXPECT_THAT(command.out(), HasSubstr("Wheel speed"));
  EXPECT_TRUE(stands_still());
  EXPECT_THAT(contents(mcap_), AllOf(StartsWith(kMcapMagic), Not(EndsWith(kMcapMagic))));
}

}  // namespace
}  // namespace cargobay::test
