// `cargobay drive --record`, `replay` and `plot`, in the order a user runs them.

#include <csignal>

#include <nlohmann/json.hpp>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class RecordTest : public DriveTest {
 protected:
  // The recording is complete, and its contents replay bit for bit.
  void expect_replays() const {
    Command command{{"replay", file_, "--json", "-"}};
    EXPECT_EQ(command.exit_code(), 0) << command.err();
    EXPECT_THAT(command.err(), IsEmpty());
    const json results = json::parse(command.out(), nullptr, false);
    ASSERT_TRUE(results.is_object()) << command.out();
    EXPECT_EQ(results.at("same"), true);
    EXPECT_EQ(results.at("finished"), true);
    EXPECT_GT(results.at("frames"), 0);
  }

  const TemporaryFolder folder_;
  const std::string file_ = folder_.path("drive.rec");
};

TEST_F(RecordTest, GoesFromDriveToReplayToPlot) {
  Command drives{drive({"--duration", "1", "--record", file_})};
  ASSERT_EQ(drives.exit_code(), 0) << drives.err();
  EXPECT_THAT(drives.out(), HasSubstr("cargobay plot " + file_));
  EXPECT_THAT(drives.out(), Not(HasSubstr("The last frames")));
  expect_replays();
  Command replays{{"replay", file_}};
  EXPECT_EQ(replays.exit_code(), 0);
  EXPECT_THAT(replays.out(), HasSubstr("commands, all identical\n"));

  Command plots{{"plot", file_}};
  EXPECT_EQ(plots.exit_code(), 0) << plots.err();
  EXPECT_THAT(plots.out(), AllOf(StartsWith("Drew "), HasSubstr(file_ + ".svg")));
  const std::string svg = contents(file_ + ".svg");
  EXPECT_THAT(svg, AllOf(StartsWith("<svg "), HasSubstr("straight at 200 mm/s"),
                         HasSubstr("Between two frames, ms")));
  Command to_output{{"plot", file_, "-o", "-"}};
  EXPECT_EQ(to_output.exit_code(), 0);
  EXPECT_EQ(to_output.out(), svg);
}

TEST_F(RecordTest, RecordsADriveThatASignalEnds) {
  Command command{drive({"--duration", "60", "--record", file_})};
  ASSERT_TRUE(starts_to_move());
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  expect_replays();
}

TEST_F(RecordTest, RecordsADriveThatFailsAndShowsItsLastFrames) {
  Command command{drive({"--duration", "60", "--record", file_})};
  ASSERT_TRUE(starts_to_move());
  server_->with_device([](hal::sim::Device& device) { device.press_power(); });
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.out(),
              AllOf(HasSubstr("The last frames before it ended"), HasSubstr("  safe "),
                    HasSubstr("waits in which nothing arrived")));
  expect_replays();
}

TEST_F(RecordTest, ShowsTheLastFramesOfADriveThatWasNotRecorded) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  server_->with_device([](hal::sim::Device& device) { device.inputs().charger = true; });
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.out(), AllOf(HasSubstr("The last frames"), HasSubstr("  passive ")));
}

// SIGKILL leaves what had been written so far.
TEST_F(RecordTest, ReadsARecordingThatWasNotFinished) {
  {
    Command command{drive({"--duration", "60", "--record", file_})};
    ASSERT_TRUE(starts_to_move());
    ASSERT_TRUE(eventually([this] { return std::filesystem::file_size(file_) > 2000; }));
    command.send(SIGKILL);
    EXPECT_EQ(command.exit_code(), -SIGKILL);
  }
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 3);
  Command replays{{"replay", file_}};
  EXPECT_EQ(replays.exit_code(), 0);
  EXPECT_THAT(replays.out(), HasSubstr("all identical"));
  EXPECT_THAT(replays.err(), HasSubstr("was not finished: read up to its last whole block"));
}

TEST_F(RecordTest, FindsWhatDiffers) {
  Command drives{drive({"--duration", "0.6", "--record", file_})};
  ASSERT_EQ(drives.exit_code(), 0) << drives.err();
  Command replays{{"replay", file_, "--lag", "0.2"}};
  EXPECT_EQ(replays.exit_code(), 0) << "another estimator is compared, not judged";
  EXPECT_THAT(replays.out(), HasSubstr("estimates differ by"));

  std::string bytes = contents(file_);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  (void)folder_.write("damaged.rec", bytes);
  for (const char* word : {"replay", "plot"}) {
    Command command{{word, folder_.path("damaged.rec")}};
    EXPECT_EQ(command.exit_code(), 1);
    EXPECT_THAT(command.err(), OneErrorLine("damaged.rec is damaged at byte "));
    EXPECT_THAT(command.out(), IsEmpty());
  }
}

TEST_F(RecordTest, RefusesWhatIsNoRecording) {
  const std::string text = folder_.write("notes.txt", "no recording\n");
  for (const char* word : {"replay", "plot"}) {
    Command command{{word, text}};
    EXPECT_EQ(command.exit_code(), 1);
    EXPECT_THAT(command.err(), OneErrorLine("notes.txt is not a recording of a drive"));
    Command missing{{word, folder_.path("nosuch.rec")}};
    EXPECT_EQ(missing.exit_code(), 1);
    EXPECT_THAT(missing.err(), OneErrorLine("nosuch.rec: No such file"));
  }
}

// A file of the same name that may not be written: nothing is sent to the robot.
TEST_F(RecordTest, NeverBeginsWhereItCannotRecord) {
  ASSERT_EQ(chmod(folder_.path("").c_str(), 0777), 0);
  (void)folder_.write("drive.rec", "mine");
  ASSERT_EQ(chmod(file_.c_str(), 0444), 0);
  Command command{drive({"--duration", "60", "--record", file_}), kNobody};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("cannot write " + file_));
  EXPECT_EQ(contents(file_), "mine");
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

// By then the robot has been brought up, and it is left properly.
TEST_F(RecordTest, LeavesAnOlderRecordingWhereTheDriveDoesNotBegin) {
  ASSERT_EQ(chmod(folder_.path("").c_str(), 0777), 0);
  (void)folder_.write("drive.rec", "mine");
  ASSERT_EQ(chmod(file_.c_str(), 0666), 0);
  Command command{drive({"--duration", "60", "--record", file_, "--require-rt"}), kNobody};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("CAP_SYS_NICE"));
  EXPECT_EQ(contents(file_), "mine");
  EXPECT_EQ(mode(), oi::Mode::passive);
}

// The drive goes on, and what was recorded by then can be read.
TEST_F(RecordTest, FailsAtALimitOfTheFileSize) {
  const Setup limited{.most_file_bytes = 8192};
  Command command{drive({"--duration", "1.5", "--record", file_}), limited};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("File too large; raise the file size limit"));
  EXPECT_THAT(command.out(), HasSubstr("Wheel speed"));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
  EXPECT_EQ(std::filesystem::file_size(file_), 8192U);
  Command replays{{"replay", file_}};
  EXPECT_EQ(replays.exit_code(), 0) << replays.err();
  EXPECT_THAT(replays.out(), HasSubstr("all identical"));
}

TEST_F(RecordTest, FailsOnAFullDisk) {
  Command command{drive({"--duration", "0.6", "--record", "/dev/full"})};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("cannot write /dev/full: No space left"));
  EXPECT_TRUE(stands_still());
}

}  // namespace
}  // namespace cargobay::test
