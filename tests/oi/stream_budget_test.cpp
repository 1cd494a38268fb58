#include "oi/stream_budget.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"

namespace cargobay::oi {
namespace {

using std::chrono::nanoseconds;
using enum PacketId;

TEST(CommandTime, HasTheSpacingThat115200Needs) {
  EXPECT_EQ(command_time(0, 115200).count(), 0);
  EXPECT_EQ(command_time(1, 115200), wire_time(1, 115200));
  EXPECT_EQ(command_time(5, 115200), 4 * kByteSpacingAt115200 + wire_time(1, 115200));
  EXPECT_EQ(command_time(5, 57600), wire_time(5, 57600));
}

TEST(StreamBudget, KnowsWhatATickCarries) {
  EXPECT_EQ(bytes_per_tick(57600), 86U);  // OI p. 14
  EXPECT_EQ(bytes_per_tick(19200), 28U);
  EXPECT_EQ(bytes_per_tick(4800), 7U);
  EXPECT_EQ(bytes_per_tick(300), 0U);
  EXPECT_EQ(bytes_per_tick(115200), 172U);
}

TEST(StreamBudget, KnowsTheBytesOfAFrame) {
  EXPECT_EQ(frame_bytes(std::array{distance, angle}), 9U);
  EXPECT_EQ(frame_bytes(std::array{group_6}), 56U);
  EXPECT_EQ(frame_bytes(std::array{cliff_front_left_signal, virtual_wall}), 8U);
  EXPECT_EQ(frame_bytes({}), 0U);
  EXPECT_EQ(frame_bytes(std::array{kRawLeftCount}, kCreateWithExtensions), 6U);
}

TEST(StreamBudget, FitsUpToTheLastByte) {
  EXPECT_TRUE(fits(std::array{distance, angle}, 9600));
  EXPECT_FALSE(fits(std::array{distance, angle}, 4800));
  EXPECT_TRUE(fits(std::array{group_6}, 57600));
  EXPECT_FALSE(fits(std::array{group_6}, 19200));
  EXPECT_FALSE(fits(std::array{wall}, 300));
  // 86 bytes exactly: 3 + 27 * 3 + 2.
  std::vector<PacketId> list(27, voltage);
  list.push_back(wall);
  ASSERT_EQ(frame_bytes(list), 86U);
  EXPECT_TRUE(fits(list, 57600));
  list.back() = voltage;
  EXPECT_FALSE(fits(list, 57600));
  // More than a frame's length can say does not fit at any rate.
  EXPECT_FALSE(fits(std::vector<PacketId>(5, group_6), 1'000'000));
}

TEST(StreamBudget, KnowsTheTimeOnTheWire) {
  EXPECT_EQ(wire_time(1, 57600), nanoseconds{173612});  // rounded up
  EXPECT_EQ(wire_time(0, 57600), nanoseconds{0});
  EXPECT_EQ(wire_time(96, 9600), nanoseconds{100'000'000});
  EXPECT_EQ(wire_time(kDriveDirectBytes, 57600), nanoseconds{868056});
  EXPECT_EQ(wire_time(kDriveDirectBytes, 19200), nanoseconds{2604167});
  for (const std::uint32_t baud : kBaudRates) {
    EXPECT_LE(wire_time(bytes_per_tick(baud), baud), kTick) << baud;
    EXPECT_GT(wire_time(bytes_per_tick(baud) + 1, baud), kTick) << baud;
  }
}

TEST(StreamBudget, KnowsWhenAPl011SaysNothing) {
  const nanoseconds timeout = bit_time(32, 57600);
  EXPECT_EQ(timeout, nanoseconds{555556});
  EXPECT_EQ(pl011_delay(16, 57600, kPl011HalfFifoPi0To3), nanoseconds{0});
  EXPECT_EQ(pl011_delay(16, 57600, kPl011HalfFifoPi4And5), nanoseconds{0});
  EXPECT_EQ(pl011_delay(8, 57600, kPl011HalfFifoPi0To3), nanoseconds{0});
  EXPECT_EQ(pl011_delay(8, 57600, kPl011HalfFifoPi4And5), timeout);
  EXPECT_EQ(pl011_delay(9, 57600, kPl011HalfFifoPi0To3), timeout);
  EXPECT_EQ(control_delay(9, 57600, kPl011HalfFifoPi0To3),
            wire_time(9, 57600) + timeout + wire_time(5, 57600));
}

TEST(Baud, HasTheCodesOfTheManual) {  // OI p. 7
  EXPECT_EQ(kCreate.baud_code(300), 0);
  EXPECT_EQ(kCreate.baud_code(19200), 7);
  EXPECT_EQ(kCreate.baud_code(57600), 10);
  EXPECT_EQ(kCreate.baud_code(115200), 11);
  EXPECT_EQ(kCreate.baud_code(56000), std::nullopt);
  EXPECT_EQ(kCreate.baud_code(0), std::nullopt);
}

}  // namespace
}  // namespace cargobay::oi
