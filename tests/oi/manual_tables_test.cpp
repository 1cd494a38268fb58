// The tables of the manual, copied again by hand, to compare the codec's own tables with.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/song.hpp"

namespace cargobay::oi {
namespace {

TEST(ManualTables, BaudCodes) {  // OI p. 7, 23
  constexpr std::array<std::uint32_t, 12> kRates{300,   600,   1200,  2400,  4800,  9600,
                                                 14400, 19200, 28800, 38400, 57600, 115200};
  EXPECT_EQ(kBaudRates, kRates);
}

struct Range {
  std::int32_t min, max;
};

void expect_ranges(std::span<const ArgumentInfo> arguments, const std::vector<Range>& ranges,
                   std::uint8_t opcode) {
  ASSERT_EQ(arguments.size(), ranges.size()) << int{opcode};
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    EXPECT_EQ(arguments[i].min, ranges[i].min) << int{opcode} << ", argument " << i;
    EXPECT_EQ(arguments[i].max, ranges[i].max) << int{opcode} << ", argument " << i;
  }
}

TEST(ManualTables, Commands) {  // OI p. 7 to 16, 22
  struct Row {
    std::uint8_t opcode;
    std::string_view name;
    std::vector<Range> arguments;
    std::vector<Range> repeated;
  };
  const std::vector<Row> rows{
      {128, "Start", {}, {}},
      {129, "Baud", {{0, 11}}, {}},
      {130, "Control", {}, {}},
      {131, "Safe", {}, {}},
      {132, "Full", {}, {}},
      {134, "Spot", {}, {}},
      {135, "Cover", {}, {}},
      {136, "Demo", {{-1, 9}}, {}},
      {137, "Drive", {{-500, 500}, {-2000, 2000}}, {}},
      {138, "Low Side Drivers", {{0, 7}}, {}},
      {139, "LEDs", {{0, 10}, {0, 255}, {0, 255}}, {}},
      {140, "Song", {{0, 15}, {1, 16}}, {{0, 255}, {0, 255}}},
      {141, "Play Song", {{0, 15}}, {}},
      {142, "Sensors", {{0, 42}}, {}},
      {143, "Cover and Dock", {}, {}},
      {144, "PWM Low Side Drivers", {{0, 128}, {0, 128}, {0, 128}}, {}},
      {145, "Drive Direct", {{-500, 500}, {-500, 500}}, {}},
      {147, "Digital Outputs", {{0, 7}}, {}},
      {148, "Stream", {{0, 43}}, {{0, 42}}},
      {149, "Query List", {{0, 255}}, {{0, 42}}},
      {150, "Pause/Resume Stream", {{0, 1}}, {}},
      {151, "Send IR", {{0, 255}}, {}},
      {152, "Script", {{0, 100}}, {{0, 255}}},
      {153, "Play Script", {}, {}},
      {154, "Show Script", {}, {}},
      {155, "Wait Time", {{0, 255}}, {}},
      {156, "Wait Distance", {{-32768, 32767}}, {}},
      {157, "Wait Angle", {{-32768, 32767}}, {}},
      {158, "Wait Event", {{-22, 22}}, {}},
  };
  ASSERT_EQ(rows.size(), kCommands.size());
  for (const Row& row : rows) {
    const CommandInfo* info = kCreate.find_command(row.opcode);
    ASSERT_NE(info, nullptr) << int{row.opcode};
    EXPECT_EQ(info->name, row.name);
    expect_ranges(info->arguments(), row.arguments, row.opcode);
    expect_ranges(element_arguments(info->tail), row.repeated, row.opcode);
  }
}

TEST(ManualTables, Demos) {  // OI p. 8
  const ArgumentInfo& demo = kCreate.find_command(136)->argument_slots[0];
  constexpr std::array<std::string_view, 11> kNames{
      "abort", "cover", "cover_and_dock", "spot_cover", "mouse", "drive_figure_eight", "wimp",
      "home",  "tag",   "pachelbel",      "banjo"};
  for (int number = -1; number <= 9; ++number) {
    EXPECT_EQ(value_name(demo, number), kNames.at(static_cast<std::size_t>(number + 1)));
  }
}

TEST(ManualTables, Bits) {  // OI p. 9, 10
  const auto name = [](std::uint8_t opcode, std::int32_t bit) {
    return value_name(kCreate.find_command(opcode)->argument_slots[0], bit);
  };
  EXPECT_EQ(name(139, 0b0010), "play");
  EXPECT_EQ(name(139, 0b1000), "advance");
  EXPECT_EQ(name(147, 0b001), "output_0");
  EXPECT_EQ(name(147, 0b010), "output_1");
  EXPECT_EQ(name(147, 0b100), "output_2");
  EXPECT_EQ(name(138, 0b001), "driver_0");
  EXPECT_EQ(name(138, 0b010), "driver_1");
  EXPECT_EQ(name(138, 0b100), "driver_2");
}

TEST(ManualTables, NoteLetters) {  // OI p. 12
  constexpr std::array<std::string_view, 97> kLetters{
      "g", "g#", "a", "a#", "b",                                        // 31 to 35
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 36 to 47
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 48 to 59
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 60 to 71
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 72 to 83
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 84 to 95
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 96 to 107
      "c", "c#", "d", "d#", "e", "f", "f#", "g", "g#", "a", "a#", "b",  // 108 to 119
      "c", "c#", "d", "d#", "e", "f", "f#", "g"};                       // 120 to 127
  for (std::size_t i = 0; i < kLetters.size(); ++i) {
    const std::string named{note_name(static_cast<std::uint8_t>(31 + i)).view()};
    EXPECT_EQ(named.substr(0, named.size() - 1), kLetters.at(i)) << 31 + i;
  }
}

TEST(ManualTables, Events) {  // OI p. 16
  struct Row {
    std::string_view name;
    std::int32_t number, inverse;
  };
  constexpr std::array<Row, 22> kRows{{{"wheel_drop", 1, 255},
                                       {"front_wheel_drop", 2, 254},
                                       {"left_wheel_drop", 3, 253},
                                       {"right_wheel_drop", 4, 252},
                                       {"bump", 5, 251},
                                       {"left_bump", 6, 250},
                                       {"right_bump", 7, 249},
                                       {"virtual_wall", 8, 248},
                                       {"wall", 9, 247},
                                       {"cliff", 10, 246},
                                       {"left_cliff", 11, 245},
                                       {"front_left_cliff", 12, 244},
                                       {"front_right_cliff", 13, 243},
                                       {"right_cliff", 14, 242},
                                       {"home_base", 15, 241},
                                       {"advance_button", 16, 240},
                                       {"play_button", 17, 239},
                                       {"digital_input_0", 18, 238},
                                       {"digital_input_1", 19, 237},
                                       {"digital_input_2", 20, 236},
                                       {"digital_input_3", 21, 235},
                                       {"mode_passive", 22, 234}}};
  const ArgumentInfo& event = kCreate.find_command(158)->argument_slots[0];
  for (const Row& row : kRows) {
    EXPECT_EQ(named_value(event, row.name), row.number);
    const auto inverse = named_value(event, "no_" + std::string{row.name});
    ASSERT_TRUE(inverse) << row.name;
    EXPECT_EQ(static_cast<std::uint8_t>(*inverse), row.inverse);
  }
}

TEST(ManualTables, Packets) {  // OI p. 17 to 21, 24
  struct Row {
    std::string_view name;
    std::uint8_t size;
    bool is_signed;
    Range range;
    Unit unit;
  };
  constexpr Range kSigned{-32768, 32767};
  constexpr Range kUnsigned{0, 65535};
  constexpr Range kSignal{0, 4095};
  constexpr Range kSpeed{-500, 500};
  constexpr std::array<Row, 36> kRows{
      {{"Bumps and Wheel Drops", 1, false, {0, 31}, Unit::none},
       {"Wall", 1, false, {0, 1}, Unit::none},
       {"Cliff Left", 1, false, {0, 1}, Unit::none},
       {"Cliff Front Left", 1, false, {0, 1}, Unit::none},
       {"Cliff Front Right", 1, false, {0, 1}, Unit::none},
       {"Cliff Right", 1, false, {0, 1}, Unit::none},
       {"Virtual Wall", 1, false, {0, 1}, Unit::none},
       {"Low Side Driver and Wheel Overcurrents", 1, false, {0, 31}, Unit::none},
       {"Unused", 1, false, {0, 0}, Unit::none},
       {"Unused", 1, false, {0, 0}, Unit::none},
       {"Infrared Byte", 1, false, {0, 255}, Unit::none},
       {"Buttons", 1, false, {0, 5}, Unit::none},
       {"Distance", 2, true, kSigned, Unit::mm},
       {"Angle", 2, true, kSigned, Unit::deg},
       {"Charging State", 1, false, {0, 5}, Unit::none},
       {"Voltage", 2, false, kUnsigned, Unit::millivolt},
       {"Current", 2, true, kSigned, Unit::milliamp},
       {"Battery Temperature", 1, true, {-128, 127}, Unit::deg_celsius},
       {"Battery Charge", 2, false, kUnsigned, Unit::milliamp_hour},
       {"Battery Capacity", 2, false, kUnsigned, Unit::milliamp_hour},
       {"Wall Signal", 2, false, kSignal, Unit::none},
       {"Cliff Left Signal", 2, false, kSignal, Unit::none},
       {"Cliff Front Left Signal", 2, false, kSignal, Unit::none},
       {"Cliff Front Right Signal", 2, false, kSignal, Unit::none},
       {"Cliff Right Signal", 2, false, kSignal, Unit::none},
       {"Cargo Bay Digital Inputs", 1, false, {0, 31}, Unit::none},
       {"Cargo Bay Analog Signal", 2, false, {0, 1023}, Unit::none},
       {"Charging Sources Available", 1, false, {0, 3}, Unit::none},
       {"OI Mode", 1, false, {0, 3}, Unit::none},
       {"Song Number", 1, false, {0, 15}, Unit::none},
       {"Song Playing", 1, false, {0, 1}, Unit::none},
       {"Number of Stream Packets", 1, false, {0, 43}, Unit::none},
       {"Requested Velocity", 2, true, kSpeed, Unit::mm_per_sec},
       {"Requested Radius", 2, true, kSigned, Unit::mm},
       {"Requested Right Velocity", 2, true, kSpeed, Unit::mm_per_sec},
       {"Requested Left Velocity", 2, true, kSpeed, Unit::mm_per_sec}}};
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    const Row& row = kRows.at(i);
    const PacketInfo& info = kPackets.at(kFirstSinglePacket + i);
    EXPECT_EQ(info.name, row.name);
    EXPECT_EQ(info.size, row.size) << row.name;
    EXPECT_EQ(info.is_signed, row.is_signed) << row.name;
    EXPECT_EQ(info.min, row.range.min) << row.name;
    EXPECT_EQ(info.max, row.range.max) << row.name;
    EXPECT_EQ(info.unit, row.unit) << row.name;
  }
}

TEST(ManualTables, PacketBits) {  // OI p. 17, 18, 20, 25
  using Names = std::array<std::string_view, 5>;
  const auto expect_bits = [](PacketId packet, const Names& names) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      EXPECT_EQ(bit_name(packet, bit), bit < names.size() ? names.at(bit) : "") << bit;
    }
  };
  expect_bits(PacketId::bumps_and_wheel_drops, {"bump_right", "bump_left", "wheel_drop_right",
                                                "wheel_drop_left", "wheel_drop_front"});
  expect_bits(PacketId::overcurrents, {"low_side_driver_1", "low_side_driver_0",
                                       "low_side_driver_2", "right_wheel", "left_wheel"});
  expect_bits(PacketId::buttons, {"play", "", "advance"});
  expect_bits(PacketId::digital_inputs,
              {"input_0", "input_1", "input_2", "input_3", "device_detect"});
  expect_bits(PacketId::charging_sources, {"internal_charger", "home_base"});
}

TEST(ManualTables, InfraredCharacters) {  // OI p. 18
  struct Row {
    std::uint8_t value;
    std::string_view name;
  };
  constexpr std::array<Row, 24> kRows{{{129, "remote left"},
                                       {130, "remote forward"},
                                       {131, "remote right"},
                                       {132, "remote spot"},
                                       {133, "remote max"},
                                       {134, "remote small"},
                                       {135, "remote medium"},
                                       {136, "remote large / clean"},
                                       {137, "remote pause"},
                                       {138, "remote power"},
                                       {139, "remote arc forward left"},
                                       {140, "remote arc forward right"},
                                       {141, "remote drive stop"},
                                       {142, "scheduling remote send all"},
                                       {143, "scheduling remote seek dock"},
                                       {240, "home base reserved"},
                                       {242, "home base force field"},
                                       {244, "home base green buoy"},
                                       {246, "home base green buoy and force field"},
                                       {248, "home base red buoy"},
                                       {250, "home base red buoy and force field"},
                                       {252, "home base red and green buoy"},
                                       {254, "home base red and green buoy and force field"},
                                       {255, "none"}}};
  for (const Row& row : kRows) EXPECT_EQ(name(InfraredCharacter{row.value}), row.name);
}

TEST(ManualTables, StatesAndModes) {  // OI p. 19, 20
  constexpr std::array<std::string_view, 6> kStates{"not charging",  "reconditioning charging",
                                                    "full charging", "trickle charging",
                                                    "waiting",       "charging fault"};
  for (std::size_t code = 0; code < kStates.size(); ++code) {
    EXPECT_EQ(name(static_cast<ChargingState>(code)), kStates.at(code));
  }
  constexpr std::array<std::string_view, 4> kModes{"off", "passive", "safe", "full"};
  for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
    EXPECT_EQ(name(static_cast<Mode>(mode)), kModes.at(mode));
  }
}

}  // namespace
}  // namespace cargobay::oi
