#include "hal/sim/robot/uart_line.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/random.hpp"
#include "oi/dialect.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

// Everything that arrives of these bytes, sent back to back.
Bytes through(const Bytes& sent, std::uint32_t sender_baud, std::uint32_t receiver_baud) {
  UartLine line{sent.size() + 1};
  for (const std::uint8_t byte : sent) line.push(0ns, byte, sender_baud);
  Bytes arrived;
  while (const auto arrival = line.pop(3600s, receiver_baud)) arrived.push_back(arrival->value);
  return arrived;
}

TEST(UartLine, TakesTenBitTimesAByte) {
  UartLine line{8};
  line.push(1000ns, 0x55, 57600);
  line.push(1000ns, 0xaa, 57600);
  EXPECT_FALSE(line.pop(1000ns + 173'611ns, 57600));
  const auto first = line.pop(1000ns + 173'612ns, 57600);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->value, 0x55);
  EXPECT_EQ(first->time, 1000ns + 173'612ns);
  EXPECT_FALSE(line.pop(1000ns + 347'222ns, 57600));
  const auto second = line.pop(1000ns + 347'223ns, 57600);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->value, 0xaa);
}

TEST(UartLine, DoesNotDriftOverALongBurst) {
  UartLine line{57600};
  for (int i = 0; i < 5760; ++i) ASSERT_TRUE(line.push(0ns, 0, 57600));
  EXPECT_EQ(line.free_at(), 1s);
}

TEST(UartLine, StartsAtOnceAfterAPause) {
  UartLine line{8};
  line.push(0ns, 1, 19200);
  line.push(10ms, 2, 19200);
  EXPECT_EQ(line.free_at(), 10ms + 520'834ns);
}

TEST(UartLine, SaysWhenTheNextByteArrives) {
  UartLine line{8};
  EXPECT_FALSE(line.next_arrival(57600));
  line.push(5ms, 1, 57600);
  line.push(5ms, 2, 57600);
  EXPECT_EQ(line.next_arrival(57600), 5ms + 173'612ns);
  EXPECT_EQ(line.batch_arrival(8), 5ms + 347'223ns);
  EXPECT_EQ(line.batch_arrival(1), 5ms + 173'612ns);
}

TEST(UartLine, RefusesWhatItHasNoRoomFor) {
  UartLine line{2};
  EXPECT_TRUE(line.push(0ns, 1, 57600));
  EXPECT_TRUE(line.push(0ns, 2, 57600));
  EXPECT_FALSE(line.push(0ns, 3, 57600));
  EXPECT_TRUE(line.pop(1s, 57600));
  EXPECT_TRUE(line.push(1s, 4, 57600));
}

TEST(UartLine, BringsEveryByteAtEveryRate) {
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  for (const std::uint32_t baud : oi::kCreate.baud_rates)
    EXPECT_EQ(through(all, baud, baud), all) << baud;
}

TEST(UartLine, ToleratesRatesThatDifferByThreePercent) {
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  for (const std::uint32_t baud : {55900U, 57000U, 58200U, 59300U}) {
    EXPECT_EQ(through(all, 57600, baud), all) << baud;
    EXPECT_EQ(through(all, baud, 57600), all) << baud;
  }
}

TEST(UartLine, GarblesWhatIsReadThreeTimesTooFast) {
  // Start and every bit three samples long: 128 is low for 24 samples, then high for 6. The
  // receiver sees a start, eight lows and a low stop, then waits for the next edge: there is none.
  UartLine line{4};
  line.push(0ns, 128, 19200);
  const auto first = line.pop(1s, 57600);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->value, 0);
  EXPECT_TRUE(first->framing_error);
  EXPECT_FALSE(line.pop(1s, 57600));
  // 0x55 alternates: each low bit of the sender is three low samples, a start and two data bits.
  EXPECT_EQ(through({0x55}, 19200, 57600), (Bytes{0x1c, 0x1c, 0xfc}));
}

TEST(UartLine, GarblesWhatIsReadThreeTimesTooSlowly) {
  // Three bytes of zeros arrive as one, made of the middles of 24 bits.
  EXPECT_EQ(through({0, 0, 0}, 57600, 19200).size(), 1U);
  EXPECT_NE(through({128, 132, 148, 1, 35}, 57600, 19200), (Bytes{128, 132, 148, 1, 35}));
}

TEST(UartLine, GarblesTheSameWayHoweverItIsAsked) {
  Random random{3};
  UartLine eager{4096};
  UartLine late{4096};
  Bytes eagerly;
  for (int i = 0; i < 2000; ++i) {
    const auto byte = static_cast<std::uint8_t>(random.next());
    const rt::Duration now = i * 200us;
    eager.push(now, byte, 57600);
    late.push(now, byte, 57600);
    while (const auto arrival = eager.pop(now, 38400)) eagerly.push_back(arrival->value);
  }
  while (const auto arrival = eager.pop(10s, 38400)) eagerly.push_back(arrival->value);
  Bytes at_last;
  while (const auto arrival = late.pop(10s, 38400)) at_last.push_back(arrival->value);
  EXPECT_EQ(eagerly, at_last);
  EXPECT_GT(at_last.size(), 1000U);
}

TEST(UartLine, IsInStepAgainAfterAPause) {
  UartLine line{64};
  for (const std::uint8_t byte : Bytes{0x12, 0x34, 0x56}) line.push(0ns, byte, 57600);
  while (line.pop(10ms, 9600)) {
  }
  line.push(20ms, 77, 9600);
  const auto arrival = line.pop(30ms, 9600);
  ASSERT_TRUE(arrival);
  EXPECT_EQ(arrival->value, 77);
  EXPECT_FALSE(arrival->framing_error);
}

}  // namespace
}  // namespace cargobay::hal::sim
