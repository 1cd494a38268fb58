#include "hal/bring_up/bring_up.hpp"

#include <array>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/guard/farewell.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"

namespace cargobay::hal {
namespace {

using testing::HasSubstr;

class BringUp : public testing::Test {
 protected:
  Result<BringUpReport> run(oi::Mode mode = oi::Mode::safe) {
    return bring_up(link_, {.mode = mode, .packets = oi::kCreate.list(oi::FrameList::reading)});
  }
  void send(std::vector<std::uint8_t> bytes) {
    (void)link_.write(bytes);
    link_.advance(std::chrono::milliseconds{100});
  }

  sim::Device device_{sim::Parameters{}};
  sim::VirtualLink link_{device_};
};

TEST_F(BringUp, LeadsFromOffToAStreamInSafe) {
  ASSERT_EQ(device_.mode(), oi::Mode::off);
  const auto report = run();
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_FALSE(report->resynchronised);
  EXPECT_EQ(report->found_baud, 57600U);
  EXPECT_EQ(report->rate_change, RateChange::none);
  EXPECT_LT(report->took, std::chrono::milliseconds{250});
  EXPECT_EQ(device_.mode(), oi::Mode::safe);
  EXPECT_TRUE(device_.stream().running());
}

TEST_F(BringUp, LeadsToFullWhereAsked) {
  ASSERT_TRUE(run(oi::Mode::full));
  EXPECT_EQ(device_.mode(), oi::Mode::full);
}

TEST_F(BringUp, TellsEachStep) {
  std::vector<std::string> steps;
  ASSERT_TRUE(bring_up(link_, {.packets = oi::kCreate.list(oi::FrameList::reading),
                               .progress = [&steps](const BringUpEvent& event) {
                                 steps.push_back(event.step + " " + event.detail);
                               }}));
  EXPECT_THAT(steps, testing::ElementsAre("Start at 57600 baud", "Stream at 57600 baud", "Safe "));
}

TEST_F(BringUp, TakesOverARobotThatIsInFullAndStreamsSomethingElse) {
  send({128, 132, 148, 2, 29, 13});
  ASSERT_EQ(device_.mode(), oi::Mode::full);
  ASSERT_TRUE(run());
  EXPECT_EQ(device_.mode(), oi::Mode::safe);
}

TEST_F(BringUp, FreesARobotStuckInAHalfSentScript) {
  send({128, 152, 100});
  const auto report = run();
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_TRUE(report->resynchronised);
}

TEST_F(BringUp, FreesARobotStuckInAHalfSentSong) {
  send({128, 140, 0, 16});
  ASSERT_TRUE(run());
}

// It streams the right list, so nothing seems wrong until it does not change its mode.
TEST_F(BringUp, FreesARobotThatStreamsAndTakesItsCommandsForData) {
  ASSERT_TRUE(run());
  send({128});
  device_.take_half_command();
  const auto report = run();
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_TRUE(report->resynchronised);
  EXPECT_EQ(device_.mode(), oi::Mode::safe);
}

TEST_F(BringUp, RefusesAStreamThatDoesNotFit) {
  ASSERT_FALSE(link_.set_baud(4800));
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.failure().message, HasSubstr("16 bytes every 15 ms do not fit 4800 baud"));
  EXPECT_THAT(report.failure().message, HasSubstr("choose 14400 baud or more"));
  EXPECT_EQ(device_.counters().bytes_received, 0U);
}

TEST_F(BringUp, SaysThatTheRobotIsSilent) {
  device_.output().clear();
  sim::Device dead{sim::Parameters{.power_on = sim::PowerOn::never}};
  sim::VirtualLink dead_link{dead};
  const auto report = bring_up(dead_link, {.packets = oi::kCreate.list(oi::FrameList::reading)});
  ASSERT_FALSE(report);
  EXPECT_THAT(report.failure().message, HasSubstr("silent at all its rates"));
  EXPECT_THAT(report.failure().message, HasSubstr("switched on"));
}

TEST_F(BringUp, SaysThatTheRobotStaysPassive) {
  device_.inputs().wheel_drop_left = true;
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.failure().message, HasSubstr("stays in passive mode instead of safe"));
  EXPECT_THAT(report.failure().message, HasSubstr("wheels"));
}

TEST_F(BringUp, SaysThatThePortHungUp) {
  link_.hang_up();
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.failure().message, HasSubstr("hung up"));
}

TEST_F(BringUp, LeavesTheRobotPassiveAfterAFailure) {
  send({128, 132, 145, 0, 200, 0, 200});
  device_.inputs().wheel_drop_left = true;  // Full does not mind, Safe will
  link_.advance(std::chrono::seconds{1});
  ASSERT_NE(device_.commanded(), rt::WheelSpeeds{});
  ASSERT_FALSE(run());
  link_.advance(std::chrono::milliseconds{100});
  EXPECT_EQ(device_.mode(), oi::Mode::passive);
  EXPECT_EQ(device_.commanded(), rt::WheelSpeeds{});
}

TEST_F(BringUp, LeaveStopsTheWheelsAndGoesPassive) {
  ASSERT_TRUE(run(oi::Mode::full));
  send({145, 0, 200, 0, 200});
  ASSERT_EQ(device_.commanded(), (rt::WheelSpeeds{200.0, 200.0}));
  EXPECT_EQ(farewell(link_), Parting::standing);
  EXPECT_EQ(device_.commanded(), rt::WheelSpeeds{});
  EXPECT_EQ(device_.mode(), oi::Mode::passive);
  EXPECT_FALSE(device_.stream().running());
}

// The stop would be three notes of the song.
TEST_F(BringUp, LeaveStopsARobotThatTakesItsCommandsForData) {
  ASSERT_TRUE(run());
  send({145, 0, 200, 0, 200});
  device_.take_half_command();
  EXPECT_EQ(farewell(link_), Parting::standing);
  EXPECT_EQ(device_.commanded(), rt::WheelSpeeds{});
  EXPECT_EQ(device_.mode(), oi::Mode::passive);
}

TEST_F(BringUp, LeaveSaysWhereNobodyConfirms) {
  ASSERT_TRUE(run());
  link_.hang_up();
  EXPECT_NE(farewell(link_), Parting::standing);
}

}  // namespace
}  // namespace cargobay::hal
