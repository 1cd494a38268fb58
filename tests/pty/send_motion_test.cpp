// `cargobay send` and what moves: wheels, demos and scripts that it starts, and how it stops them.

#include <cmath>
#include <csignal>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_tool.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class SendMotion : public RobotTool {};

TEST_F(SendMotion, RefusesWhatTheModeDoesNotAllow) {
  EXPECT_THAT(error_of({"start; drive 100 straight"}),
              HasSubstr("the robot is in passive mode and would ignore drive; put 'safe;' before "
                        "it"));
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U) << "nothing was sent";
  EXPECT_EQ(send({"start"}).code, 0);
  EXPECT_THAT(error_of({"safe; spot; leds none 0 0"}), HasSubstr("would ignore leds"));
  EXPECT_THAT(error_of({"leds none 0 0"}), HasSubstr("would ignore leds"));
}

TEST_F(SendMotion, RefusesWaitsOutsideScripts) {
  for (const std::string command :
       {"wait_time 5", "wait_distance 100", "wait_angle 90", "wait_event bump"}) {
    EXPECT_THAT(error_of({"start; " + command}),
                HasSubstr("is for scripts: outside one the robot goes deaf"));
  }
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U);
}

TEST_F(SendMotion, StopsTheWheelsAfterTheDuration) {
  const Outcome outcome = send({"--duration", "0.2", "start; safe; drive_direct 100 -100"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("stopped the wheels"));
  EXPECT_FALSE(turning());
  const hal::sim::Snapshot after = server_->snapshot();
  EXPECT_EQ(after.mode, oi::Mode::passive) << "Safe does not charge";
  EXPECT_GT(std::abs(after.truth.pose.heading_rad), 0.01) << "they did turn";
}

TEST_F(SendMotion, StopsTheWheelsOnASignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    ToolProcess process{with_port("send", {"start; full; drive 200 straight"})};
    ASSERT_TRUE(eventually([this] { return turning(); }));
    process.send_signal(signal);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 128 + signal);
    EXPECT_THAT(outcome.error, HasSubstr("the wheels may be turning; Ctrl-C stops them"));
    EXPECT_THAT(outcome.error, HasSubstr("stopped the wheels"));
    EXPECT_FALSE(turning());
  }
}

TEST_F(SendMotion, StopsADemo) {
  const Outcome outcome = send({"--duration", "0.2", "start; cover"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("stopped the wheels"));
  EXPECT_TRUE(stopped());
  EXPECT_EQ(server_->snapshot().mode, oi::Mode::passive);
}

TEST_F(SendMotion, AStopEndsADemoThatAnotherStarted) {
  for (const char* const stop : {"stop", "drive_direct 0 0", "drive 0 straight"}) {
    EXPECT_EQ(send({"--leave-running", "start; cover"}).code, 0);
    ASSERT_TRUE(eventually([this] { return turning(); })) << stop;
    const Outcome outcome = send({stop});
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("in passive mode: if it ran a demo, that was ended"));
    EXPECT_TRUE(stopped()) << stop;
    EXPECT_EQ(server_->snapshot().mode, oi::Mode::passive);
  }
}

TEST_F(SendMotion, AStopAfterADemoEndsIt) {
  const Outcome outcome = send({"start; cover; stop; sensors oi_mode"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("1 (passive)"));
  EXPECT_THAT(outcome.error, Not(HasSubstr("wheels"))) << "nothing is left to stop";
  EXPECT_TRUE(stopped());
}

TEST_F(SendMotion, AStopKeepsTheMode) {
  EXPECT_EQ(send({"--leave-running", "start; full; drive 100 straight"}).code, 0);
  ASSERT_TRUE(eventually([this] { return turning(); }));
  const Outcome outcome = send({"stop"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_TRUE(stopped());
  EXPECT_EQ(server_->snapshot().mode, oi::Mode::full);
}

// Its answers are lost, and it moves.
TEST_F(SendMotion, AStopIsSentToARobotThatIsNotHeard) {
  EXPECT_EQ(send({"--leave-running", "start; full; drive 100 straight"}).code, 0);
  ASSERT_TRUE(eventually([this] { return turning(); }));
  server_->with_cable([](hal::sim::Cable& cable) { cable.faults_to_host().bytes.lost = 1.0; });
  EXPECT_THAT(error_of({"stop"}), HasSubstr("It was told to stop all the same; if it moves, press "
                                            "its power button"));
  EXPECT_TRUE(stopped());
}

TEST_F(SendMotion, StopsWhatAScriptStarted) {
  const Outcome outcome =
      send({"--duration", "0.2", "start; safe; script { drive 200 straight }; play_script"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_FALSE(turning());
}

TEST_F(SendMotion, SaysWhenAScriptIsDeaf) {
  const Outcome outcome = send({"--duration", "0.1",
                                "start; safe; script { drive 200 straight; wait_event cliff }; "
                                "play_script"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("if it is waiting in a script it is deaf until that ends"));
}

TEST_F(SendMotion, StopsTheWheelsAfterAFailure) {
  EXPECT_THAT(error_of({"start; safe; drive 200 straight; firmware_date"}),
              HasSubstr("stopped the wheels\ncargobay: error: the robot did not answer"));
  EXPECT_TRUE(stopped());
}

TEST_F(SendMotion, WaitsForAScriptNoLongerThanTheDuration) {
  EXPECT_THAT(error_of({"--duration", "0.5",
                        "start; safe; drive 200 straight; script { wait_event play_button }; "
                        "play_script; sensors 35"}),
              HasSubstr("the robot has not answered since it began the script"));
}

TEST_F(SendMotion, WaitsWhileAScriptWaits) {
  const Outcome outcome =
      send({"start; full; script { drive 300 straight; wait_distance 60; drive 0 0 }; play_script; "
            "sensors distance"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, StartsWith(" 19  Distance"));
  EXPECT_THAT(outcome.error, HasSubstr("the script waits, and the robot is deaf until"));
  EXPECT_THAT(outcome.error, Not(HasSubstr("stopped the wheels"))) << "the script did";
  EXPECT_FALSE(turning());
}

TEST_F(SendMotion, SaysHowLongTheScriptWaitsAndEndsWithIt) {
  const Outcome outcome =
      send({"start; safe; script { drive 200 straight; wait_time 7; drive 0 0; wait_time 1 }; "
            "play_script"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.error,
            "cargobay: the script waits for 0.8 s, and the robot is deaf meanwhile; waiting for "
            "it\n");
  EXPECT_FALSE(turning());
  EXPECT_GT(server_->snapshot().truth.pose.x_mm, 50.0);
}

TEST_F(SendMotion, StopsWhatAScriptLeavesTurning) {
  const Outcome outcome = send(
      {"--duration", "1", "start; safe; script { wait_time 2; drive 200 straight }; play_script"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("stopped the wheels"));
  EXPECT_FALSE(turning());
}

TEST_F(SendMotion, LeavesAScriptThatWaitsIfASignalComes) {
  ToolProcess process{with_port(
      "send", {"start; safe; script { wait_event play_button }; play_script; sensors 7"})};
  ASSERT_TRUE(eventually([&process] {
    return process.printed_so_far().find("the script waits") != std::string::npos;
  }));
  process.send_signal(SIGINT);
  EXPECT_EQ(process.wait().code, 128 + SIGINT);
}

TEST_F(SendMotion, StopsWhatRawBytesMayHaveStarted) {
  // A velocity out of range.
  const Outcome outcome = send({"--duration", "0.1", "start; full; bytes 137 2 88 128 0"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("stopped the wheels"));
  EXPECT_TRUE(stopped());
}

TEST_F(SendMotion, EndsAtOnceWhenTheWheelsStandStill) {
  const Outcome outcome = send({"start; safe; drive 200 straight; drive 0 straight"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.error, Not(HasSubstr("wheels")));
  EXPECT_EQ(send({"script { leds play 0 0; wait_time 1 }; play_script"}).code, 0)
      << "a script that drives nothing";
}

TEST_F(SendMotion, LeavesTheWheelsRunningIfAskedTo) {
  const Outcome outcome = send({"--leave-running", "start; safe; drive 100 straight"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.error, HasSubstr("--leave-running"));
  EXPECT_TRUE(eventually([this] { return turning(); }));
}

}  // namespace
}  // namespace cargobay::test
