#include "hal/sim/line/virtual_link.hpp"

#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers
using Wait = ByteStream::Wait;

TEST(VirtualLink, WaitsUntilTheThresholdHasArrived) {
  Robot robot;
  robot.send({128, 148, 1, 35});
  ASSERT_FALSE(robot.link.set_wake_threshold(5));
  EXPECT_EQ(robot.link.wait(robot.link.now() + 1s), Wait::ready);
  EXPECT_EQ(robot.link.cable().available(), 5U);
}

TEST(VirtualLink, TimesOutAtTheDeadlineExactly) {
  Robot robot;
  const rt::TimePoint deadline = robot.link.now() + 123'456'789ns;
  EXPECT_EQ(robot.link.wait(deadline), Wait::timed_out);
  EXPECT_EQ(robot.link.now(), deadline);
  EXPECT_EQ(robot.link.wait(deadline - 1s), Wait::timed_out) << "a deadline in the past";
  EXPECT_EQ(robot.link.now(), deadline);
}

TEST(VirtualLink, DoesNotMakeTimePassByReadingAndWriting) {
  Robot robot;
  const Bytes bytes{128};
  EXPECT_EQ(robot.link.write(bytes).count, 1U);
  EXPECT_TRUE(robot.receive().empty());
  EXPECT_EQ(robot.link.now().time_since_epoch(), 0ns);
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
}

TEST(VirtualLink, DeliversAByteWhenItHasArrivedWhole) {
  Robot robot;
  (void)robot.link.write(Bytes{128});
  robot.wait(173'611ns);
  EXPECT_EQ(robot.device.mode(), oi::Mode::off);
  robot.wait(1ns);
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
}

TEST(VirtualLink, DrainsUntilTheLastByteHasLeft) {
  Robot robot;
  (void)robot.link.write(Bytes{128, 132, 142, 35});
  EXPECT_FALSE(robot.link.drain(100us));
  EXPECT_EQ(robot.link.now().time_since_epoch(), 100us);
  EXPECT_TRUE(robot.link.drain(1s));
  EXPECT_EQ(robot.link.now().time_since_epoch(), 694'445ns);
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
}

TEST(VirtualLink, TakesWhatItHasRoomFor) {
  Robot robot;
  const Bytes many(5000, 0);
  EXPECT_EQ(robot.link.write(many).count, 4096U);
  EXPECT_EQ(robot.link.write(many).count, 0U);
  robot.wait(10s);
  EXPECT_EQ(robot.link.write(many).count, 4096U);
}

TEST(VirtualLink, DropsInputOnRequest) {
  Robot robot;
  robot.send({128, 142, 0});
  robot.wait(20ms);
  robot.link.discard_input();
  EXPECT_TRUE(robot.receive().empty());
}

TEST(VirtualLink, CountsWhatAHostThatNeverReadsLoses) {
  Robot robot;
  robot.send({128, 148, 1, 6});
  robot.wait(10s);
  EXPECT_EQ(robot.link.cable().available(), 4096U);
  EXPECT_GT(robot.link.cable().counters().host_overruns, 30'000U);
}

TEST(VirtualLink, RefusesWhatIsNoRateAndNoThreshold) {
  Robot robot;
  EXPECT_TRUE(robot.link.set_baud(0));
  EXPECT_TRUE(robot.link.set_wake_threshold(0));
  EXPECT_TRUE(robot.link.set_wake_threshold(256));
  EXPECT_EQ(robot.link.baud(), 57600U);
}

TEST(VirtualLink, StaysHungUp) {
  Robot robot;
  robot.link.hang_up();
  EXPECT_EQ(robot.link.wait(robot.link.now() + 1s), Wait::hung_up);
  EXPECT_EQ(robot.link.write(Bytes{128}).error, EIO);
  Bytes buffer(4);
  EXPECT_EQ(robot.link.read(buffer).error, EIO);
}

}  // namespace
}  // namespace cargobay::hal::sim
