// `cargobay send`: what is sent, and what is shown of the answers.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oi/limits.hpp"
#include "robot_tool.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using testing::HasSubstr;
using testing::StartsWith;

class SendTool : public RobotTool {};

TEST_F(SendTool, PrintsReplies) {
  const Outcome outcome = send({"start;", "sensors", "35;", "query_list", "7", "oi_mode"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.out,
            " 35  OI Mode                                 1 (passive)\n"
            "  7  Bumps and Wheel Drops                   none\n"
            " 35  OI Mode                                 1 (passive)\n");
}

// A lower bound: only the tool itself makes it this slow.

TEST_F(SendTool, AsksNoMoreOftenThanTheRobotTicks) {
  constexpr int kQuestions = 20;
  std::string commands = "start";
  for (int i = 0; i < kQuestions; ++i) commands += "; sensors oi_mode";
  const rt::TimePoint begin = rt::Clock::now();
  const Outcome outcome = send({commands});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_GE(rt::Clock::now() - begin, (kQuestions - 1) * oi::kTick);
}

TEST_F(SendTool, SaysWhenTheRobotIsSilent) {
  EXPECT_THAT(
      error_of({"sensors 35"}),
      HasSubstr(
          "the robot does not answer at 57600 baud; is it switched on and connected, "
          "and is this its baud rate? `cargobay bringup` finds it at any. If it is off, begin "
          "with: start"));
  EXPECT_THAT(error_of({"--baud", "19200", "start"}), HasSubstr("does not answer at 19200 baud"));
}

TEST_F(SendTool, SaysWhenThereIsNoRobot) {
  const Outcome outcome = run_tool({"send", "--port", "/nowhere/at/all", "start"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("cannot open /nowhere/at/all: no such port"));
}

TEST_F(SendTool, RefusesAStreamThatDoesNotFit) {
  EXPECT_THAT(error_of({"start; baud 19200; stream 6"}),
              HasSubstr("frames of 56 bytes every 15 ms do not fit 19200 baud, which carries 28"));
}

TEST_F(SendTool, SendsRawBytes) {
  const Outcome outcome = send({"start; bytes 142 7; bytes 173; sensors 35"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, StartsWith("  7  Bumps and Wheel Drops"));
  EXPECT_THAT(outcome.out, HasSubstr(" 35  OI Mode "));
  EXPECT_EQ(server_->snapshot().device.unknown_opcodes, 1U);
}

TEST_F(SendTool, ShowsWhatAnswersRawBytes) {
  // A packet that the manual does not have, in a list: the robot answers for the ones before it.
  EXPECT_THAT(send({"start; bytes 149 2 35 200"}).out, HasSubstr("answer: 01"));
}

TEST_F(SendTool, SaysThatARobotDoesNotKnowAnExtension) {
  EXPECT_THAT(error_of({"start; firmware_date"}), HasSubstr("did not answer firmware_date"));
}

TEST_F(SendTool, RefusesWhatARestartedRobotWouldIgnore) {
  EXPECT_THAT(error_of({"start; soft_reset; safe"}),
              HasSubstr("the robot is in off mode and would ignore safe; put 'start;' before it"));
}

TEST_F(SendTool, OnlyListens) {
  EXPECT_EQ(send({"--leave-running", "--listen", "0", "start; stream oi_mode"}).code, 0);
  ASSERT_TRUE(eventually([this] { return server_->snapshot().device.frames_sent > 0; }));
  const std::uint64_t commands = server_->snapshot().device.commands;
  const Outcome outcome = send({"--listen", "0.3"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("oi_mode 1 (passive)\n"));
  EXPECT_EQ(server_->snapshot().device.commands, commands);
  EXPECT_EQ(server_->snapshot().device.unknown_opcodes, 0U);
}

TEST_F(SendTool, SaysThatNothingArrived) {
  const Outcome outcome = send({"--listen", "0.2"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.error, HasSubstr("nothing arrived in 0.2 s at 57600 baud"));
}

// Under ssh standard input is a pipe that says nothing and does not end.

TEST_F(SendTool, OnlyListensWhileStandardInputIsSilent) {
  const std::string pipe = "/tmp/cargobay-silent-" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int held_open = open(pipe.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(held_open, 0);
  ToolProcess silent{with_port("send", {"--listen", "0.2"}), ToolProcess::InputFile{pipe}};
  const Outcome outcome = silent.wait();
  close(held_open);
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("standard input says nothing: only listening"));
  EXPECT_THAT(outcome.error, HasSubstr("nothing arrived in 0.2 s"));
}

TEST_F(SendTool, ReadsCommandsFromStandardInputWhenItListens) {
  const Outcome outcome =
      run_tool(with_port("send", {"--listen", "0.2"}), "start; stream oi_mode\n");
  EXPECT_THAT(outcome.out, HasSubstr("oi_mode 1 (passive)\n"));
}

TEST_F(SendTool, SaysThatNothingAnswersRawBytes) {
  EXPECT_THAT(send({"start; bytes 173"}).error, HasSubstr("nothing came back"));
}

TEST_F(SendTool, SaysHowANumberIsSent) {
  EXPECT_THAT(error_of({"173"}), HasSubstr("write: bytes BYTE ..., such as bytes 142 7"));
}

TEST_F(SendTool, PrintsTextAndOtherBytesWhileItListens) {
  ToolProcess process{with_port("send", {"--listen", "60"})};
  const auto prints = [&process](const std::string& line) {
    return eventually([&] { return process.printed_so_far().find(line) != std::string::npos; });
  };
  // Again and again: it may not be listening yet.
  EXPECT_TRUE(eventually([&] {
    server_->with_device([](hal::sim::Device& device) { device.print("\x81\x02\x03"); });
    return process.printed_so_far().find("bytes: 81 02 03") != std::string::npos;
  }));
  server_->with_device([](hal::sim::Device& device) { device.print("bl-start\r\n"); });
  EXPECT_TRUE(prints("text: bl-start\n"));
  process.send_signal(SIGTERM);
  EXPECT_EQ(process.wait().code, 128 + SIGTERM);
}

TEST_F(SendTool, StoresATuneInSeveralSlots) {
  std::string tune = "tune 3 scale:d=8,o=5,b=120:c";
  for (int i = 1; i < 18; ++i) tune += ",d";
  const Outcome outcome = send({"start; safe; " + tune + "; play 4; sensors song_number"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr(" 4\n"));
  EXPECT_THAT(outcome.error, HasSubstr("play 3 (4.00 s), then play 4 (0.50 s)"));
}

TEST_F(SendTool, PrintsFramesWhileItListens) {
  const Outcome outcome = send({"--listen", "0.3", "start; stream distance oi_mode"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("distance 0 mm, oi_mode 1 (passive)\n"));
  EXPECT_GT(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 5);
  EXPECT_TRUE(streams_no_longer());
}

TEST_F(SendTool, EndsAStreamOfPacketsThatTheManualDoesNotHave) {
  const Outcome outcome = send({"--listen", "0.3", "start; bytes 148 2 35 200"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("oi_mode 1 (passive)\n"));
  EXPECT_TRUE(streams_no_longer());
}

TEST_F(SendTool, TellsRepliesFromAStream) {
  const Outcome outcome =
      send({"--listen", "0.1", "start; stream 19 20 35; sensors oi_mode; sensors 35"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  // A frame may come before a reply, or between the two.
  std::map<std::string, int> lines;
  std::istringstream printed{outcome.out};
  for (std::string line; std::getline(printed, line);) ++lines[line];
  EXPECT_EQ(lines[" 35  OI Mode                                 1 (passive)"], 2);
  EXPECT_GT(lines["distance 0 mm, angle 0 deg, oi_mode 1 (passive)"], 0);
  EXPECT_EQ(lines.size(), 2U) << outcome.out;
}

TEST_F(SendTool, FindsAStreamThatRunsAlready) {
  EXPECT_EQ(send({"--leave-running", "--listen", "0", "start; stream 6"}).code, 0);
  const Outcome outcome = send({"sensors 35"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.out, " 35  OI Mode                                 1 (passive)\n");
}

TEST_F(SendTool, ShowsTheScript) {
  const std::string script = "script { drive 300 straight; wait_distance 400; drive 0 0 }";
  EXPECT_EQ(send({"start; " + script + "; show_script"}).out, script + "\n");
  EXPECT_EQ(send({"script { }; show_script"}).out, "script { }\n");
}

TEST_F(SendTool, FollowsAChangeOfTheBaudRate) {
  const Outcome outcome = send({"start; baud 19200; sensors 35; baud 38400; sensors 35"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 2);
  EXPECT_THAT(outcome.error,
              HasSubstr("the robot now runs at 38400 baud; next time: --baud 38400"));
  EXPECT_EQ(server_->snapshot().baud, 38400U);
  EXPECT_EQ(send({"--baud", "38400", "song 0 60:1 62:1 64:1; sensors 35"}).code, 0);
}

TEST_F(SendTool, PrintsTheRobotsText) {
  ToolProcess process{with_port("send", {"start; safe; drive 100 straight"})};
  ASSERT_TRUE(eventually([this] { return turning(); }));
  ASSERT_TRUE(eventually(
      [&process] { return process.printed_so_far().find("Ctrl-C") != std::string::npos; }));
  server_->with_device([](hal::sim::Device& device) { device.print("bat:   min 0\r\n"); });
  ASSERT_TRUE(eventually([&process] {
    return process.printed_so_far().find("text: bat:   min 0\n") != std::string::npos;
  }));
  process.send_signal(SIGINT);
  EXPECT_EQ(process.wait().code, 128 + SIGINT);
}

TEST_F(SendTool, SaysWhenThePortHangsUp) {
  ToolProcess process{with_port("send", {"start; safe; drive 100 straight"})};
  ASSERT_TRUE(eventually([this] { return turning(); }));
  ASSERT_TRUE(eventually(
      [&process] { return process.printed_so_far().find("Ctrl-C") != std::string::npos; }));
  server_.reset();
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("the port hung up"));
}

TEST_F(SendTool, PointsAtWhatIsWrong) {
  EXPECT_THAT(error_of({"safe; drive 600 0"}), HasSubstr("\n              ^^^\n"));
  EXPECT_THAT(error_of({"--baud", "1", "safe"}), HasSubstr("the robot does not support 1 baud"));
}

}  // namespace
}  // namespace cargobay::test
