#include "oi/command_table.hpp"

#include <set>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"

namespace cargobay::oi {
namespace {

TEST(CommandTable, AnswersForAllOpcodes) {
  for (unsigned opcode = 0; opcode < 256; ++opcode) {
    const bool in_manual = (opcode >= 128 && opcode <= 158) && opcode != 133 && opcode != 146;
    const CommandInfo* info = kCreate.find_command(static_cast<std::uint8_t>(opcode));
    ASSERT_EQ(info != nullptr, in_manual) << opcode;
    if (info != nullptr) {
      EXPECT_EQ(info->opcode, opcode);
      EXPECT_EQ(kCreate.find_command(info->key), info);
    }
  }
}

TEST(CommandTable, KeysAreUnique) {
  std::set<std::string_view> keys;
  for (const CommandInfo& info : kCommands) EXPECT_TRUE(keys.insert(info.key).second) << info.key;
  EXPECT_EQ(kCreate.find_command("no_such_command"), nullptr);
}

TEST(CommandTable, RangesFitTheirBytes) {
  for (const CommandInfo& info : kCommands) {
    for (const ArgumentInfo& argument : info.arguments()) {
      const int bits = argument.size * 8;
      EXPECT_GE(argument.min, argument.is_signed ? -(1 << (bits - 1)) : 0) << info.key;
      EXPECT_LE(argument.max, argument.is_signed ? (1 << (bits - 1)) - 1 : (1 << bits) - 1)
          << info.key;
      EXPECT_TRUE(argument.accepts(argument.max) || argument.mask != 0xff) << info.key;
    }
    EXPECT_EQ(element_arguments(info.tail).empty(), info.tail == Tail::none);
    std::size_t size = 0;
    for (const ArgumentInfo& argument : element_arguments(info.tail)) size += argument.size;
    EXPECT_EQ(size, element_size(info.tail));
  }
}

TEST(CommandTable, SaysInWhichModesACommandIsAvailable) {
  for (const CommandInfo& info : kCommands) {
    // Only Start leaves Off.
    EXPECT_EQ(info.available_in(Mode::off), info.opcode == 128) << info.key;
    EXPECT_EQ(info.available_in(Mode::passive), !info.actuates) << info.key;
    EXPECT_TRUE(info.available_in(Mode::safe)) << info.key;
    EXPECT_TRUE(info.available_in(Mode::full)) << info.key;
  }
  // OI p. 9 to 12: commands that drive, light, sound or switch need Safe or Full; Song only stores.
  for (const int opcode : {137, 138, 139, 141, 144, 145, 147, 151}) {
    EXPECT_TRUE(kCreate.find_command(static_cast<std::uint8_t>(opcode))->actuates) << opcode;
  }
  EXPECT_FALSE(kCreate.find_command(140)->actuates);
}

TEST(CommandTable, SaysHowManyDataBytes) {
  struct Row {
    std::uint8_t opcode;
    std::size_t bytes;
  };
  for (const Row& row :
       {Row{128, 0}, {129, 1}, {130, 0}, {131, 0}, {132, 0}, {134, 0}, {135, 0}, {136, 1},
        {137, 4},    {138, 1}, {139, 3}, {140, 2}, {141, 1}, {142, 1}, {143, 0}, {144, 3},
        {145, 4},    {147, 1}, {148, 1}, {149, 1}, {150, 1}, {151, 1}, {152, 1}, {153, 0},
        {154, 0},    {155, 1}, {156, 2}, {157, 2}, {158, 1}}) {
    EXPECT_EQ(kCreate.find_command(row.opcode)->argument_bytes(), row.bytes) << int{row.opcode};
  }
}

TEST(CommandTable, AcceptsExactlyTheManualsValues) {
  const auto& radius = kCreate.find_command(137)->argument_slots[1];
  EXPECT_TRUE(radius.accepts(-32768));
  EXPECT_TRUE(radius.accepts(32767));
  EXPECT_TRUE(radius.accepts(2000));
  EXPECT_FALSE(radius.accepts(2001));
  EXPECT_FALSE(radius.accepts(32766));
  const auto& leds = kCreate.find_command(139)->argument_slots[0];
  for (int bits = 0; bits < 256; ++bits) {
    EXPECT_EQ(leds.accepts(bits), bits == 0 || bits == 2 || bits == 8 || bits == 10) << bits;
  }
  const auto& event = kCreate.find_command(158)->argument_slots[0];
  for (int number = -128; number < 128; ++number) {
    EXPECT_EQ(event.accepts(number), number != 0 && number >= -22 && number <= 22) << number;
  }
  const auto& demo = kCreate.find_command(136)->argument_slots[0];
  for (int number = -128; number < 128; ++number) {
    EXPECT_EQ(demo.accepts(number), number >= -1 && number <= 9) << number;
  }
}

}  // namespace
}  // namespace cargobay::oi
