// What any Create does of its manual's Input, asked only over its serial line, so that any other
// device can be asked the same.
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <tuple>

#include <gtest/gtest.h>

#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"
#include "tests/conformance/subject.hpp"

namespace cargobay::conformance {
namespace {

using InputCommands = Conformance;

// --- Input (OI p. 13, 14) ---

TEST_F(InputCommands, EveryPacketHasItsSize) {
  for (std::uint8_t id = 0; id < oi::kPacketCount; ++id) {
    send({142, id});
    EXPECT_EQ(listen(40ms).size(), oi::kCreate.packet_size(id)) << int{id};
  }
}

TEST_F(InputCommands, EveryPacketIsInItsRange) {
  for (std::uint8_t id = oi::kFirstSinglePacket; id < oi::kPacketCount; ++id) {
    const oi::PacketInfo& info = oi::kPackets[id];
    const Bytes data = ask({142, id}, info.size);
    ASSERT_EQ(data.size(), info.size) << int{id};
    std::int32_t value = data[0];
    if (info.size == 2) value = value * 256 + data[1];
    if (info.is_signed && info.size == 2 && value > 32767) value -= 65536;
    if (info.is_signed && info.size == 1 && value > 127) value -= 256;
    EXPECT_GE(value, info.min) << info.name;
    EXPECT_LE(value, info.max) << info.name;
  }
}

TEST_F(InputCommands, WhatIsNoPacketHasNoAnswer) {
  send({142, 100});
  EXPECT_TRUE(listen(50ms).empty());
  EXPECT_EQ(mode(), 1);
}

TEST_F(InputCommands, ChargingAgreesWithItsSources) {
  send({149, 2, 21, 34});
  const Bytes state = receive(2);
  ASSERT_EQ(state.size(), 2U);
  EXPECT_TRUE(state[1] != 0 || state[0] == 0) << "nothing charges out of nothing";
  send({132});
  EXPECT_EQ(packet(21), 0) << "Full does not charge";
}

TEST_F(InputCommands, ChargeIsAtMostTheCapacity) {
  const Bytes battery = ask({149, 2, 25, 26}, 4);
  ASSERT_EQ(battery.size(), 4U);
  EXPECT_LE(battery[0] * 256 + battery[1], battery[2] * 256 + battery[3]);
}

TEST_F(InputCommands, CliffsAgreeWithTheirSignals) {
  const Bytes seen = ask({149, 8, 9, 10, 11, 12, 28, 29, 30, 31}, 12);
  ASSERT_EQ(seen.size(), 12U);
  for (std::size_t i = 0; i < 4; ++i) {
    const int signal = seen[4 + 2 * i] * 256 + seen[5 + 2 * i];
    EXPECT_TRUE(seen[i] == 1 || signal > 0) << "a floor reflects";
  }
}

TEST_F(InputCommands, TheLongestGroupIsAllPackets) {
  Bytes list{149, 36};
  for (std::uint8_t id = 7; id <= 42; ++id) list.push_back(id);
  const Bytes group = ask({142, 6}, 52);
  const Bytes one_by_one = ask(list, 52);
  ASSERT_EQ(group.size(), 52U);
  ASSERT_EQ(one_by_one.size(), 52U);
  // Except what changes by itself: the battery's five, at 16 to 25 of the 52.
  const auto battery_from = [](const Bytes& bytes) { return bytes.begin() + 16; };
  EXPECT_TRUE(std::equal(group.begin(), battery_from(group), one_by_one.begin()));
  EXPECT_TRUE(std::equal(battery_from(group) + 10, group.end(), battery_from(one_by_one) + 10));
}

TEST_F(InputCommands, EachGroupIsItsPacketsInOrder) {
  wait(50ms);
  for (const auto& [group, first, last] : {std::tuple{0, 7, 26},
                                           {1, 7, 16},
                                           {2, 17, 20},
                                           {3, 21, 26},
                                           {4, 27, 34},
                                           {5, 35, 42},
                                           {6, 7, 42}}) {
    Bytes list{149, static_cast<std::uint8_t>(last - first + 1)};
    std::size_t size = 0;
    std::size_t battery = 0;
    for (int id = first; id <= last; ++id) {
      if (id == 22) battery = size;
      list.push_back(static_cast<std::uint8_t>(id));
      size += oi::kCreate.packet_size(static_cast<std::uint8_t>(id));
    }
    Bytes whole = ask({142, static_cast<std::uint8_t>(group)}, size);
    Bytes singly = ask(list, size);
    ASSERT_EQ(whole.size(), size) << group;
    ASSERT_EQ(singly.size(), size) << group;
    // Except what changes by itself: voltage, current, temperature and charge.
    for (Bytes* bytes : {&whole, &singly}) {
      if (first <= 22 && last >= 22) {
        std::fill_n(bytes->begin() + static_cast<std::ptrdiff_t>(battery), 7, std::uint8_t{0});
      }
    }
    EXPECT_EQ(whole, singly) << "group " << group;
    EXPECT_TRUE(listen(40ms).empty()) << "group " << group;
  }
}

TEST_F(InputCommands, QueryListTakes255Packets) {
  Bytes list{149, 255};
  list.resize(2 + 255, 35);
  EXPECT_EQ(ask(list, 255), Bytes(255, 1));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(InputCommands, StreamTakes43Packets) {
  Bytes list{148, 43};
  list.resize(2 + 43, 35);
  send(list);
  send({150, 0});
  wait(200ms);
  EXPECT_EQ(packet(38), 43);
  send({148, 0});
}

TEST_F(InputCommands, ChangeNoSoonerThanATick) {
  // Moving values are read as fast as the line allows: most readings are of the same tick.
  send({132, 145, 0, 100, 0, 100});
  wait(500ms);
  int readings = 0;
  int changes = 0;
  const rt::TimePoint before = stream().now();
  while (stream().now() - before < 600ms) {
    ++readings;
    if (word_packet(19) != 0) ++changes;
  }
  const auto ticks = (stream().now() - before) / 15ms;
  send({145, 0, 0, 0, 0});
  EXPECT_LE(changes, ticks + 1);
  if (readings < 2 * ticks) GTEST_SKIP() << "this line is too slow to tell";
  EXPECT_GT(changes, ticks / 2);
}

TEST_F(InputCommands, QueryListTakesGroups) {
  EXPECT_EQ(ask({149, 3, 0, 35, 6}, 26 + 1 + 52).size(), 79U);
  EXPECT_TRUE(listen(50ms).empty());
}

// At the rate of the line: 2.3 s at 57600.
TEST_F(InputCommands, TheLongestQueryListIsAnsweredWhole) {
  Bytes list{149, 255};
  list.resize(257, 6);
  send(list);
  EXPECT_EQ(receive(255 * std::size_t{52}, 20s).size(), 255U * 52U);
  EXPECT_TRUE(listen(50ms).empty());
  EXPECT_EQ(mode(), 1);
}

TEST_F(InputCommands, WhatIsNoPacketInAListIsPassedOver) {
  EXPECT_EQ(ask({149, 3, 35, 100, 37}, 2), (Bytes{1, 0}));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(InputCommands, GroupsAreTheirPacketsInOrder) {
  send({132, 145, 0, 0, 0, 0});
  wait(50ms);
  const Bytes group = ask({142, 5}, 12);
  const Bytes list = ask({149, 8, 35, 36, 37, 38, 39, 40, 41, 42}, 12);
  EXPECT_EQ(group, list);
}

TEST_F(InputCommands, QueryListAnswersInTheOrderAsked) {
  send({132});
  EXPECT_EQ(ask({149, 3, 35, 37, 35}, 3), (Bytes{3, 0, 3}));
  send({149, 0});
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(InputCommands, StreamSendsFramesThatAddUp) {
  send({148, 2, 29, 13});
  const Bytes frames = receive(80);
  send({150, 0});
  ASSERT_EQ(frames.size(), 80U);
  for (std::size_t at = 0; at < frames.size(); at += 8) {
    const std::span<const std::uint8_t> frame{frames.data() + at, 8};
    EXPECT_EQ(frame[0], 19);
    EXPECT_EQ(frame[1], 5);
    EXPECT_EQ(frame[2], 29);
    EXPECT_EQ(frame[5], 13);
    EXPECT_TRUE(oi::checksum_matches(frame, oi::Checksum::automatic));
  }
}

TEST_F(InputCommands, StreamSendsAFrameEachFifteenMilliseconds) {
  send({148, 1, 35});
  (void)receive(5);
  const rt::TimePoint before = stream().now();
  (void)receive(5 * 100, 5s);
  const rt::Duration period = (stream().now() - before) / 100;
  send({150, 0});
  EXPECT_GT(period, 14ms);
  EXPECT_LT(period, 16ms);
}

TEST_F(InputCommands, StreamFitsTheLongestGroup) {
  send({148, 1, 6});
  const Bytes frames = receive(560, 2s);
  send({150, 0});
  ASSERT_EQ(frames.size(), 560U);
  bool including = true;
  bool excluding = true;
  for (std::size_t at = 0; at < frames.size(); at += 56) {
    const std::span<const std::uint8_t> frame{frames.data() + at, 56};
    EXPECT_EQ(frame[0], 19);
    EXPECT_EQ(frame[1], 53);
    EXPECT_EQ(frame[2], 6);
    including = including && oi::checksum_matches(frame, oi::Checksum::including_header);
    excluding = excluding && oi::checksum_matches(frame, oi::Checksum::excluding_header);
  }
  EXPECT_NE(including, excluding) << "one of the two, always the same";
}

TEST_F(InputCommands, StreamCountsItsPackets) {
  EXPECT_EQ(ask({148, 3, 7, 8, 9, 150, 0, 142, 38}, 1).size(), 1U);
  wait(100ms);
  EXPECT_EQ(packet(38), 3);
}

TEST_F(InputCommands, ARepliesBytesAreNotInAFrame) {
  send({148, 2, 35, 37});
  (void)receive(7);
  send({150, 0});
  wait(50ms);
  EXPECT_EQ(mode(), 1);
  send({150, 1});
  const Bytes frames = receive(14);
  ASSERT_EQ(frames.size(), 14U);
  EXPECT_EQ(frames[0], 19);
  EXPECT_EQ(frames[7], 19);
}

TEST_F(InputCommands, StreamIsPausedResumedAndReplaced) {
  send({148, 1, 35});
  (void)receive(5);
  send({150, 0});
  wait(100ms);
  EXPECT_TRUE(listen(100ms).empty());
  EXPECT_EQ(packet(38), 1);
  send({150, 1});
  EXPECT_EQ(receive(5).size(), 5U);
  send({148, 2, 35, 37});
  wait(100ms);
  const Bytes frames = receive(14);
  send({148, 0});
  const std::array<std::uint8_t, 3> of_two{19, 4, 35};
  EXPECT_NE(std::search(frames.begin(), frames.end(), of_two.begin(), of_two.end()), frames.end());
  wait(100ms);
  EXPECT_TRUE(listen(100ms).empty());
}

TEST_F(InputCommands, AStreamOfMoreThanFortyThreePacketsIsNotTaken) {
  send({148, 2, 35, 37});
  (void)receive(7);
  Bytes longer{148, 44};
  longer.resize(46, 35);
  send(longer);
  wait(100ms);
  const Bytes frames = receive(7);
  send({150, 0});
  ASSERT_EQ(frames.size(), 7U);
  EXPECT_EQ(frames[1], 4) << "the one before goes on";
}

TEST_F(InputCommands, StreamOutlastsAChangeOfMode) {
  send({148, 1, 35});
  send({132});
  wait(100ms);
  const Bytes frames = receive(10);
  send({150, 0});
  const std::array<std::uint8_t, 3> full{2, 35, 3};
  EXPECT_NE(std::search(frames.begin(), frames.end(), full.begin(), full.end()), frames.end());
}

}  // namespace
}  // namespace cargobay::conformance
