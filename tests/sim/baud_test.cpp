// OI p. 7: the Baud command, and what arrives at another rate.
#include "oi/baud.hpp"

#include <gtest/gtest.h>

#include "hal/sim/rate_change.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

TEST(Baud, ChangesToEachOfTheTwelveRatesAndBack) {
  for (std::size_t code = 0; code < oi::kBaudRates.size(); ++code) {
    Robot robot;
    robot.send({128, 129, static_cast<std::uint8_t>(code)});
    robot.wait(100ms);
    ASSERT_FALSE(robot.link.set_baud(oi::kBaudRates[code]));
    robot.send({142});
    robot.wait(200us);  // 115200 needs it
    robot.send({35});
    robot.wait(100ms);
    EXPECT_EQ(robot.receive(), (Bytes{1})) << oi::kBaudRates[code];
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
  for (const std::uint32_t baud : oi::kBaudRates) {
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

// Found by fuzzing: a host at a very slow rate was handed the bytes that had gone by, all at once,
// when it changed to theirs.
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

// Found by fuzzing: one byte at 1 baud held up all that came behind it.
TEST(Baud, DoesNotWaitForEverForWhatWasSentTooSlowly) {
  Robot robot;
  ASSERT_FALSE(robot.link.set_baud(1));
  EXPECT_EQ(robot.link.write(Bytes(100, 128)).count, 100U);
  robot.wait(100ms);
  ASSERT_FALSE(robot.link.set_baud(57600));
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
  EXPECT_LT(robot.link.now().time_since_epoch(), 3s);
  // What would have left in time does.
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

TEST(RateChange, PutsABaudCommandAndWhatIsBeforeItAtTheFormerRate) {
  EXPECT_EQ(sent_before_change(Bytes{129, 7}, 19200), 2U);
  EXPECT_EQ(sent_before_change(Bytes{128, 129, 7, 128}, 19200), 3U);
  EXPECT_EQ(sent_before_change(Bytes{128, 129, 7}, 57600), 0U);
  EXPECT_EQ(sent_before_change(Bytes{128, 132}, 19200), 0U);
  EXPECT_EQ(sent_before_change(Bytes{}, 19200), 0U);
  EXPECT_EQ(sent_before_change(Bytes{129, 7}, 12345), 0U);
}

}  // namespace
}  // namespace cargobay::hal::sim
