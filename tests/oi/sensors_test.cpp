#include "oi/sensors.hpp"

#include <array>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"
#include "oi/value_names.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {
namespace {

TEST(DecodePacket, AnswersForAllIds) {
  for (unsigned id = 0; id < 256; ++id) {
    const auto byte = static_cast<std::uint8_t>(id);
    for (std::size_t size = 0; size <= 53; ++size) {
      SensorValues values;
      const bool right = id < kPacketCount && size == kCreate.packet_size(byte);
      EXPECT_EQ(decode_packet(byte, Bytes(size, 1), values), right) << id << " " << size;
      for (std::uint8_t single = kFirstSinglePacket; single <= kLastPacket; ++single) {
        const bool within =
            right && single >= kPackets[byte].first && single <= kPackets[byte].last;
        EXPECT_EQ(values.has(PacketId{single}), within) << id << " " << int{single};
      }
    }
  }
}

TEST(EncodePacket, AnswersForAllIds) {
  for (unsigned id = 0; id < 256; ++id) {
    const auto byte = static_cast<std::uint8_t>(id);
    std::array<std::uint8_t, 60> out{};
    EXPECT_EQ(encode_packet(byte, SensorValues{}, out), kCreate.packet_size(byte));
    const std::size_t size = kCreate.packet_size(byte);
    if (size == 0) continue;
    EXPECT_EQ(encode_packet(byte, SensorValues{}, std::span{out}.first(size - 1)), 0U);
  }
}

TEST(DecodePacket, ReadsEveryValueOfEverySinglePacket) {
  for (std::uint8_t id = kFirstSinglePacket; id <= kLastPacket; ++id) {
    const PacketInfo& info = kPackets[id];
    std::uint64_t outside = 0;
    SensorValues values;
    for (unsigned raw = 0; raw < (info.size == 1 ? 256U : 65536U); ++raw) {
      Bytes data;
      if (info.size == 2) data.push_back(static_cast<std::uint8_t>(raw >> 8U));
      data.push_back(static_cast<std::uint8_t>(raw));
      ASSERT_TRUE(decode_packet(id, data, values));
      std::int32_t expected = static_cast<std::int32_t>(raw);
      const std::int32_t half = info.size == 1 ? 0x80 : 0x8000;
      if (info.is_signed && expected >= half) expected -= 2 * half;
      ASSERT_EQ(values.raw(PacketId{id}), expected) << info.key;
      if (expected < info.min || expected > info.max) ++outside;
      ASSERT_EQ(values.out_of_range(), outside) << info.key << " " << expected;
      std::array<std::uint8_t, 2> back{};
      ASSERT_EQ(encode_packet(id, values, back), info.size);
      ASSERT_EQ(Bytes(back.begin(), back.begin() + info.size), data);
    }
  }
}

TEST(DecodePacket, ReadsGroupsInTheOrderOfTheirMembers) {
  std::mt19937 random{1};
  for (std::uint8_t group = 0; group < kFirstSinglePacket; ++group) {
    for (int round = 0; round < 1000; ++round) {
      Bytes data(kCreate.packet_size(group));
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      SensorValues values;
      ASSERT_TRUE(decode_packet(group, data, values));
      std::size_t at = 0;
      for (std::uint8_t id = kPackets[group].first; id <= kPackets[group].last; ++id) {
        SensorValues single;
        ASSERT_TRUE(
            decode_packet(id, std::span{data}.subspan(at, kCreate.packet_size(id)), single));
        ASSERT_EQ(values.raw(PacketId{id}), single.raw(PacketId{id}));
        at += kCreate.packet_size(id);
      }
      std::array<std::uint8_t, 52> back{};
      ASSERT_EQ(encode_packet(group, values, back), data.size());
      ASSERT_TRUE(std::equal(data.begin(), data.end(), back.begin()));
    }
  }
}

TEST(SensorValues, VisitsWhatWasSetInRisingOrder) {
  SensorValues values;
  values.set(kRawRightCount, 7);
  values.set(PacketId::angle, -3);
  values.set(PacketId::bumps_and_wheel_drops, 0);
  std::vector<std::pair<int, std::int32_t>> seen;
  const auto see = [&](PacketId packet, std::int32_t value) {
    seen.emplace_back(static_cast<int>(packet), value);
  };
  values.visit(see);
  const decltype(seen) set{{7, 0}, {20, -3}, {44, 7}};
  EXPECT_EQ(seen, set);
  values.clear();
  values.visit(see);
  EXPECT_EQ(seen, set) << "nothing behind clear()";
}

TEST(SensorValues, NamesItsFields) {
  SensorValues values;
  // Packet 6 with a different value in each place.
  const Bytes data{
      0b00010010, 1,    0, 1,  0,    1,    0,    0b00001001, 0, 0,    248,     0b100,  // 7 to 18
      0xff,       0xfe, 0, 90, 4,    0x40, 0,    0xff,       0, 0xf6, 0x0a,    0,
      0x0b,       0xb8,  // 19 to 26
      0,          1,    0, 2,  0,    3,    0,    4,          0, 5,    0b10001, 3,
      0xff,       2,                                                                   // 27 to 34
      2,          7,    1, 5,  0xff, 0x38, 0x80, 0,          0, 100,  0xff,    0x9c};  // 35 to 42
  ASSERT_TRUE(decode_packet(6, data, values));
  EXPECT_TRUE(values.bumps_and_wheel_drops().has(Bump::bump_left));
  EXPECT_TRUE(values.bumps_and_wheel_drops().has(Bump::wheel_drop_front));
  EXPECT_FALSE(values.bumps_and_wheel_drops().has(Bump::bump_right));
  EXPECT_TRUE(values.wall());
  EXPECT_FALSE(values.cliff_left());
  EXPECT_TRUE(values.cliff_front_left());
  EXPECT_FALSE(values.cliff_front_right());
  EXPECT_TRUE(values.cliff_right());
  EXPECT_FALSE(values.virtual_wall());
  EXPECT_TRUE(values.overcurrents().has(Overcurrent::low_side_driver_1));  // bit 0 is driver 1
  EXPECT_FALSE(values.overcurrents().has(Overcurrent::low_side_driver_0));
  EXPECT_TRUE(values.overcurrents().has(Overcurrent::right_wheel));
  EXPECT_EQ(values.infrared(), InfraredCharacter::home_base_red_buoy);
  EXPECT_TRUE(values.buttons().has(Button::advance));
  EXPECT_FALSE(values.buttons().has(Button::play));
  EXPECT_EQ(values.distance(), Mm{-2});
  EXPECT_EQ(values.angle(), Deg{90});
  EXPECT_EQ(values.charging_state(), ChargingState::waiting);
  EXPECT_EQ(values.voltage(), MilliVolt{0x4000});
  EXPECT_EQ(values.current(), MilliAmp{-256});
  EXPECT_EQ(values.battery_temperature(), DegCelsius{-10});
  EXPECT_EQ(values.battery_charge(), MilliAmpHour{0x0a00});
  EXPECT_EQ(values.battery_capacity(), MilliAmpHour{3000});
  EXPECT_EQ(values.wall_signal(), 1);
  EXPECT_EQ(values.cliff_left_signal(), 2);
  EXPECT_EQ(values.cliff_front_left_signal(), 3);
  EXPECT_EQ(values.cliff_front_right_signal(), 4);
  EXPECT_EQ(values.cliff_right_signal(), 5);
  EXPECT_TRUE(values.digital_inputs().has(DigitalInput::input_0));
  EXPECT_TRUE(values.digital_inputs().has(DigitalInput::device_detect));
  EXPECT_EQ(values.analog_signal(), 0x3ff);
  EXPECT_TRUE(values.charging_sources().has(ChargingSource::home_base));
  EXPECT_FALSE(values.charging_sources().has(ChargingSource::internal_charger));
  EXPECT_EQ(values.mode(), Mode::safe);
  EXPECT_EQ(values.song_number(), 7);
  EXPECT_TRUE(values.song_playing());
  EXPECT_EQ(values.stream_packets(), 5);
  EXPECT_EQ(values.requested_velocity(), MmPerSec{-200});
  EXPECT_EQ(values.requested_radius(), kStraight);
  EXPECT_EQ(values.requested_right_velocity(), MmPerSec{100});
  EXPECT_EQ(values.requested_left_velocity(), MmPerSec{-100});
  EXPECT_EQ(values.out_of_range(), 0U);
}

TEST(SensorValues, DeliversAndCountsWhatTheManualDoesNotHave) {
  SensorValues values;
  ASSERT_TRUE(decode_packet(35, Bytes{7}, values));
  ASSERT_TRUE(decode_packet(21, Bytes{9}, values));
  ASSERT_TRUE(decode_packet(18, Bytes{0xff}, values));
  EXPECT_EQ(values.out_of_range(), 3U);
  EXPECT_EQ(values.mode(), Mode{7});
  EXPECT_EQ(name(values.mode()), "unknown");
  EXPECT_EQ(name(values.charging_state()), "unknown");
  EXPECT_EQ(values.buttons().raw(), 0xff);
  values.clear();
  EXPECT_FALSE(values.has(PacketId::oi_mode));
  EXPECT_EQ(values.out_of_range(), 3U);
}

TEST(SensorValues, NamesCharactersAndBits) {
  EXPECT_EQ(name(InfraredCharacter{255}), "none");
  EXPECT_EQ(name(InfraredCharacter{0}), "unknown");
  int named = 0;
  for (int character = 0; character < 256; ++character) {
    if (name(InfraredCharacter{static_cast<std::uint8_t>(character)}) != "unknown") ++named;
  }
  EXPECT_EQ(named, 15 + 8 + 1);  // remotes, home base, none
  EXPECT_EQ(bit_name(PacketId::overcurrents, 0), "low_side_driver_1");
  EXPECT_EQ(bit_name(PacketId::overcurrents, 1), "low_side_driver_0");
  EXPECT_EQ(bit_name(PacketId::buttons, 1), "");
  EXPECT_EQ(bit_name(PacketId::wall, 0), "");
  EXPECT_EQ(bit_name(PacketId::digital_inputs, 8), "");
}

TEST(Frame, OfTheManualIsDecodedAndEncoded) {  // OI p. 14
  const Bytes by_the_manual{19, 5, 29, 2, 25, 13, 0, 182};
  const Bytes by_robots{19, 5, 29, 2, 25, 13, 0, 163};
  SensorValues values;
  ASSERT_TRUE(decode_frame(by_robots, values));
  EXPECT_EQ(values.cliff_front_left_signal(), 537);
  EXPECT_FALSE(values.virtual_wall());
  const std::array packets{PacketId::cliff_front_left_signal, PacketId::virtual_wall};
  std::array<std::uint8_t, 8> out{};
  ASSERT_EQ(encode_frame(packets, values, Checksum::excluding_header, out), out.size());
  EXPECT_EQ(Bytes(out.begin(), out.end()), by_the_manual);
  ASSERT_EQ(encode_frame(packets, values, Checksum::including_header, out), out.size());
  EXPECT_EQ(Bytes(out.begin(), out.end()), by_robots);
  EXPECT_EQ(encode_frame(packets, values, Checksum::including_header, std::span{out}.first(7)), 0U);
}

TEST(Frame, IsRefusedWhereItsStructureIsWrong) {
  SensorValues values;
  for (const Bytes& frame : {Bytes{}, Bytes{19}, Bytes{19, 0, 237}, Bytes{18, 2, 35, 2, 0},
                             Bytes{19, 3, 35, 2, 0}, Bytes{19, 2, 43, 2, 0}, Bytes{19, 2, 19, 2, 0},
                             Bytes{19, 2, 35, 2}, Bytes{19, 2, 35, 2, 0, 0}}) {
    EXPECT_FALSE(decode_frame(frame, values)) << testing::PrintToString(frame);
  }
  EXPECT_FALSE(values.has(PacketId::oi_mode));
}

TEST(EncodeFrame, RefusesWhatNoFrameHolds) {
  std::array<std::uint8_t, 600> out{};
  const std::vector<PacketId> four(4, PacketId::group_6);
  const std::vector<PacketId> five(5, PacketId::group_6);
  EXPECT_EQ(encode_frame(four, SensorValues{}, Checksum::including_header, out), 3U + 4 * 53);
  EXPECT_EQ(encode_frame(five, SensorValues{}, Checksum::including_header, out), 0U);
  EXPECT_EQ(encode_frame({}, SensorValues{}, Checksum::including_header, out), 0U);
  const std::array unknown{PacketId{43}};
  EXPECT_EQ(encode_frame(unknown, SensorValues{}, Checksum::including_header, out), 0U);
  // A length can say 255 bytes at most, which is exactly 85 words.
  const std::vector<PacketId> most(85, PacketId::voltage);
  const std::vector<PacketId> too_many(86, PacketId::voltage);
  EXPECT_EQ(encode_frame(most, SensorValues{}, Checksum::including_header, out), kMaxFrameBytes);
  EXPECT_EQ(encode_frame(too_many, SensorValues{}, Checksum::including_header, out), 0U);
}

TEST(Extensions, AreDecodedOnlyWhenAskedFor) {
  SensorValues values;
  const Bytes data{1, 2};
  EXPECT_FALSE(decode_packet(43, data, values));
  EXPECT_TRUE(decode_packet(43, data, values, kCreateWithExtensions));
  EXPECT_FALSE(decode_packet(45, data, values, kCreateWithExtensions));
  EXPECT_EQ(values.raw(kRawLeftCount), 258);
  EXPECT_EQ(raw_count_difference(65530, 4), 10);
  EXPECT_EQ(kCreateWithExtensions.find_packet(44)->key, "raw_right_count");
  EXPECT_EQ(kCreate.find_packet(44), nullptr);
  EXPECT_EQ(kCreate.find_packet(42), kCreate.find_packet(42));
}

TEST(Extensions, KnowTheAnswerWithTheFirmwareDate) {
  const FirmwareDate date{.year = 7, .month = 9, .day = 24, .hour = 13, .minute = 5};
  const auto answer = firmware_date_answer(date);
  EXPECT_EQ(answer[0], 18);
  EXPECT_EQ(parse_firmware_date(answer), date);
  for (std::size_t i = 0; i < answer.size(); ++i) {
    auto damaged = answer;
    damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ 1U);
    EXPECT_EQ(parse_firmware_date(damaged), std::nullopt);
  }
  EXPECT_EQ(parse_firmware_date(std::span{answer}.first(6)), std::nullopt);
}

}  // namespace
}  // namespace cargobay::oi
