#include "oi/packet_table.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "oi/text/packet_name.hpp"

namespace cargobay::oi {
namespace {

TEST(PacketTable, AnswersForAllIds) {
  for (unsigned id = 0; id < 256; ++id) {
    const PacketInfo* info = kCreate.find_packet(static_cast<std::uint8_t>(id));
    if (id > 42) {
      EXPECT_EQ(info, nullptr) << id;
      EXPECT_EQ(kCreate.packet_size(static_cast<std::uint8_t>(id)), 0U);
      EXPECT_EQ(packet_named(std::to_string(id)), std::nullopt);
      continue;
    }
    ASSERT_NE(info, nullptr) << id;
    EXPECT_EQ(info->id, id);
    EXPECT_EQ(info->is_group(), id < 7);
    EXPECT_EQ(packet_named(std::to_string(id)), id);
    EXPECT_EQ(packet_named(info->key), id);
    EXPECT_EQ(kCreate.packet_size(static_cast<std::uint8_t>(id)), info->size);
  }
}

TEST(PacketTable, HasTheGroupsOfTheManual) {  // OI p. 17
  struct Group {
    std::uint8_t id, size, first, last;
  };
  for (const Group& group :
       {Group{0, 26, 7, 26}, Group{1, 10, 7, 16}, Group{2, 6, 17, 20}, Group{3, 10, 21, 26},
        Group{4, 14, 27, 34}, Group{5, 12, 35, 42}, Group{6, 52, 7, 42}}) {
    EXPECT_EQ(kPackets[group.id].size, group.size);
    EXPECT_EQ(kPackets[group.id].first, group.first);
    EXPECT_EQ(kPackets[group.id].last, group.last);
  }
}

TEST(PacketTable, KeysAreUniqueAndInOneSpelling) {
  std::set<std::string_view> keys;
  for (const PacketInfo& info : kPackets) {
    EXPECT_TRUE(keys.insert(info.key).second) << info.key;
    EXPECT_EQ(info.key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789"),
              std::string_view::npos);
    EXPECT_FALSE(info.name.empty());
  }
}

TEST(PacketTable, RangesFitTheirBytes) {
  for (const PacketInfo& info : kPackets) {
    if (info.is_group()) continue;
    const int bits = info.size * 8;
    const int least = info.is_signed ? -(1 << (bits - 1)) : 0;
    const int most = info.is_signed ? (1 << (bits - 1)) - 1 : (1 << bits) - 1;
    EXPECT_GE(info.min, least) << info.key;
    EXPECT_LE(info.max, most) << info.key;
    EXPECT_LE(info.min, info.max) << info.key;
  }
}

TEST(PacketTable, FindsNothingByOtherNames) {
  for (const char* text :
       {"", " ", "Wall", "wall ", "43", "-1", "+7", "0x", "7.", "256", "99999999999"}) {
    EXPECT_EQ(packet_named(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace cargobay::oi
