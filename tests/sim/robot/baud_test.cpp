// OI p. 7: the Baud command, and what arrives at another rate.

#include <gtest/gtest.h>

#include "hal/sim/line/host_rate_change.hpp"
#include "oi/dialect.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

TEST(Baud, ChangesToEachOfTheTwelveRatesAndBack) {
  for (std::size_t code = 0; code < oi::kCreate.baud_rates.size(); ++code) {
    Robot robot;
    robot.send({128, 129, static_cast<std::uint8_t>(code)});
    robot.wait(100ms);
    ASSERT_FALSE(robot.link.set_baud(oi::kCreate.baud_rates[code]));
    robot.send({142});
    robot.wait(200us);  // 115200 needs it
    robot.send({35});
    robot.wait(100ms);
    EXPECT_EQ(robot.receive(), (Bytes{1})) << oi::kCreate.baud_rates[code];
  }
}

TEST(Baud, IgnoresACodeItDoesNotHave) {
  Robot robot;
  robot.send({128, 129, 12});
  EXPECT_EQ(robot.device.baud(), 57600U);
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Baud, ChangesWhenTheLastByteHasLeft) {
  Robot robot;
  robot.send({128, 142, 6, 129, 7});
  robot.wait(8ms);
  EXPECT_EQ(robot.device.baud(), 57600U);
  robot.wait(1ms);
  EXPECT_EQ(robot.device.baud(), 19200U);
  EXPECT_EQ(robot.receive().size(), 52U);
}

TEST(Baud, HearsNothingForAHundredMilliseconds) {
  Robot robot;
  robot.send({128, 129, 7});
  robot.wait(90ms);
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.send({132});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
  EXPECT_EQ(robot.device.counters().bytes_unheard, 1U);
  robot.wait(10ms);
  robot.send({132});
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
}

TEST(Baud, IsBootedAtTheRateItIsGiven) {
  Parameters parameters;
  parameters.boot_baud = 19200;
  Robot robot{parameters};
  EXPECT_EQ(robot.link.baud(), 19200U);
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
}

TEST(Baud, HearsNoStartAtAWrongRate) {
  for (const std::uint32_t baud : oi::kCreate.baud_rates) {
    if (baud == 57600) continue;
    Robot robot;
    ASSERT_FALSE(robot.link.set_baud(baud));
    robot.send({128});
    robot.wait(100ms);
    EXPECT_EQ(robot.device.mode(), oi::Mode::off) << baud;
  }
}

TEST(Baud, GarblesTheStreamAtAWrongRate) {
  Robot robot;
  robot.send({128, 148, 1, 35});
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.wait(1s);
  const Bytes garbled = robot.receive();
  EXPECT_FALSE(garbled.empty());
  EXPECT_EQ(std::count(garbled.begin(), garbled.end(), 19), 0);
}

// Found by fuzzing: when a host at a very slow rate changed to the robot's, it got all the bytes
// that had gone by at once.
TEST(Baud, IsNotHeardAfterwardsAtTheRateItWasMissedAt) {
  Robot robot;
  ASSERT_FALSE(robot.link.set_baud(1));
  robot.device.print("far too fast for one bit a second");
  robot.wait(100ms);
  ASSERT_FALSE(robot.link.set_baud(57600));
  robot.wait(100ms);
  EXPECT_TRUE(robot.receive().empty());
  robot.device.print("heard");
  robot.wait(1ms);
  EXPECT_EQ(robot.receive(), (Bytes{'h', 'e', 'a', 'r', 'd'}));
}

// Found by fuzzing: one byte at 1 baud held up everything after it.
TEST(Baud, DoesNotWaitForEverForWhatWasSentTooSlowly) {
  Robot robot;
  ASSERT_FALSE(robot.link.set_baud(1));
  EXPECT_EQ(robot.link.write(Bytes(100, 128)).count, 100U);
  robot.wait(100ms);
  ASSERT_FALSE(robot.link.set_baud(57600));
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
  EXPECT_LT(robot.link.now().time_since_epoch(), 3s);
  // Bytes that would have left in time do leave.
  ASSERT_FALSE(robot.link.set_baud(19200));
  ASSERT_FALSE(robot.link.set_baud(57600));
  EXPECT_EQ(robot.link.write(Bytes{131, 132}).count, 2U);
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.wait(10ms);
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
}

TEST(Baud, LosesBytesThatComeTooFastAt115200) {
  Parameters parameters;
  parameters.boot_baud = 115200;
  Robot robot{parameters};
  robot.send({128, 132});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive) << "86.8 us after the one before";
  robot.wait(200us);
  robot.send({132});
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
  EXPECT_EQ(robot.device.counters().bytes_unheard, 1U);
}

TEST(HostRateChange, PutsABaudCommandAndWhatIsBeforeItAtTheFormerRate) {
  EXPECT_EQ(sent_before_change(Bytes{129, 7}, 19200), 2U);
  EXPECT_EQ(sent_before_change(Bytes{128, 129, 7, 128}, 19200), 3U);
  EXPECT_EQ(sent_before_change(Bytes{128, 129, 7}, 57600), 0U);
  EXPECT_EQ(sent_before_change(Bytes{128, 132}, 19200), 0U);
  EXPECT_EQ(sent_before_change(Bytes{}, 19200), 0U);
  EXPECT_EQ(sent_before_change(Bytes{129, 7}, 12345), 0U);
}

TEST(HostRateChange, FindsABaudCommandThatComesInPieces) {
  const rt::TimePoint begin{3600s};
  HostRateChange change;
  EXPECT_FALSE(change.under_way());
  change.begin(115200, 57600, 0, begin);
  ASSERT_TRUE(change.under_way());
  EXPECT_EQ(change.decided_at(), begin + 100ms) << "what comes later was sent later";
  rt::TimePoint now = begin + 20ms;
  for (const std::uint8_t byte : Bytes{150, 0, 129}) {
    change.keep(Bytes{byte}, now);
    now += 1ms;
    EXPECT_GT(change.decided_at(), now) << int{byte};
  }
  now += 50ms;
  EXPECT_GT(change.decided_at(), now) << "a Baud command is never cut";
  change.keep(Bytes{10}, now);
  EXPECT_LE(change.decided_at(), now);
  EXPECT_EQ(change.before(), 4U);
  EXPECT_EQ(change.former(), 115200U);
}

TEST(HostRateChange, FindsABaudCommandThatHadBegun) {
  const rt::TimePoint begin{3600s};
  HostRateChange change;
  change.begin(115200, 57600, 129, begin);
  EXPECT_EQ(change.before(), 0U);
  change.keep(Bytes{10, 128}, begin + 20ms);
  EXPECT_LE(change.decided_at(), begin + 20ms);
  EXPECT_EQ(change.before(), 1U);
  change.begin(115200, 57600, 129, begin);
  change.keep(Bytes{7}, begin + 20ms);
  EXPECT_EQ(change.before(), 0U);
}

TEST(HostRateChange, KeepsWhatIsNoBaudCommandForAFewMillisecondsOnly) {
  const rt::TimePoint begin{3600s};
  HostRateChange change;
  change.begin(57600, 19200, 0, begin);
  change.keep(Bytes{128}, begin + 30ms);
  EXPECT_EQ(change.decided_at(), begin + 35ms);
  change.keep(Bytes{132}, begin + 33ms);
  EXPECT_EQ(change.decided_at(), begin + 35ms);
  EXPECT_EQ(change.before(), 0U);
  EXPECT_EQ(change.kept().size(), 2U);
}

TEST(HostRateChange, KeepsNoMoreThanItHasRoomFor) {
  const rt::TimePoint begin{3600s};
  HostRateChange change;
  change.begin(57600, 19200, 0, begin);
  EXPECT_EQ(change.room(100), 100U);
  change.keep(Bytes(60, 0), begin);
  EXPECT_EQ(change.room(100), 40U);
  EXPECT_EQ(change.room(50), 0U);
  change.keep(Bytes(HostRateChange::kMostBytes - 60, 0), begin);
  EXPECT_EQ(change.room(4096), 0U);
  EXPECT_EQ(change.decided_at(), begin) << "at once";
}

}  // namespace
}  // namespace cargobay::hal::sim
