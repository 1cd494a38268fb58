// The bytes of MCAP, by its specification (https://mcap.dev/spec). Others read whole files in
// tests/export/others/others_read_it.py.
#include "hal/export/mcap_writer.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hal/recording/recording_format.hpp"

namespace cargobay::hal {
namespace {

class McapWriterTest : public testing::Test {
 protected:
  WriteBytes write() {
    return [this](std::string_view bytes) -> Result<void> {
      file_ += bytes;
      return {};
    };
  }
  std::uint64_t number(std::size_t at, std::size_t size) const {
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;)
      value = value << 8U | static_cast<std::uint8_t>(file_.at(at + i));
    return value;
  }
  // The offsets of all records with this opcode, in the file or in a chunk.
  std::vector<std::size_t> find(std::uint8_t opcode) const {
    std::vector<std::size_t> found;
    for (std::size_t at = kMcapMagic.size(); at + 9 <= file_.size() - kMcapMagic.size();
         at += 9 + number(at + 1, 8)) {
      if (static_cast<std::uint8_t>(file_[at]) == opcode) found.push_back(at);
    }
    return found;
  }
  std::uint32_t crc(std::size_t begin, std::size_t end) const {
    const std::vector<std::uint8_t> bytes(file_.begin() + static_cast<std::ptrdiff_t>(begin),
                                          file_.begin() + static_cast<std::ptrdiff_t>(end));
    return crc32(bytes);
  }
  void write_two_messages() {
    McapWriter writer{write(), "test"};
    const auto schema = writer.add_schema("thing", "{}");
    const auto channel = writer.add_channel("/things", schema);
    writer.message(channel, 20, "{}");
    writer.message(channel, 30, "{}");
    ASSERT_TRUE(writer.finish());
  }

  std::string file_{};
};

TEST_F(McapWriterTest, BeginsWithMagicAndHeader) {
  const McapWriter writer{write(), "me"};
  const std::string wanted{
      "\x89MCAP0\r\n"
      "\x01\x0A\0\0\0\0\0\0\0"  // header, 10 bytes
      "\0\0\0\0"                // no profile
      "\x02\0\0\0me",
      8 + 9 + 10};
  EXPECT_EQ(file_, wanted);
}

TEST_F(McapWriterTest, EndsWithAFooterThatLeadsToTheSummary) {
  write_two_messages();
  EXPECT_TRUE(file_.ends_with(kMcapMagic));
  const std::size_t footer = file_.size() - kMcapMagic.size() - 29;
  EXPECT_EQ(find(0x02), std::vector{footer});
  const std::uint64_t summary = number(footer + 9, 8);
  const std::uint64_t offsets = number(footer + 17, 8);
  EXPECT_EQ(summary, find(0x0F).at(0) + 9 + 4) << "right after the end of the data";
  EXPECT_EQ(offsets, find(0x0E).at(0));
  EXPECT_EQ(number(footer + 25, 4), crc(summary, footer + 25));
}

TEST_F(McapWriterTest, HasTheChecksumOfItsData) {
  write_two_messages();
  const std::size_t end = find(0x0F).at(0);
  EXPECT_EQ(number(end + 9, 4), crc(0, end));
}

TEST_F(McapWriterTest, HasAChunkWithItsTimesAndChecksum) {
  write_two_messages();
  ASSERT_EQ(find(0x06).size(), 1U);
  const std::size_t chunk = find(0x06)[0] + 9;
  constexpr std::size_t kMessage = 9 + 22 + 2;
  EXPECT_EQ(number(chunk, 8), 20U);
  EXPECT_EQ(number(chunk + 8, 8), 30U);
  EXPECT_EQ(number(chunk + 16, 8), 2 * kMessage);
  const std::size_t records = chunk + 28 + 4 + 8;
  EXPECT_EQ(number(chunk + 24, 4), crc(records, records + 2 * kMessage));
  EXPECT_EQ(number(records, 1), 0x05U);
}

TEST_F(McapWriterTest, HasAnIndexThatLeadsToChunkAndMessages) {
  write_two_messages();
  const std::size_t chunk = find(0x06).at(0);
  const std::size_t index = find(0x07).at(0);
  EXPECT_EQ(number(index + 9 + 2, 4), 32U) << "two entries";
  EXPECT_EQ(number(index + 9 + 6, 8), 20U);
  EXPECT_EQ(number(index + 9 + 14, 8), 0U);
  EXPECT_EQ(number(index + 9 + 22, 8), 30U);
  EXPECT_EQ(number(index + 9 + 30, 8), 33U);
  const std::size_t chunk_index = find(0x08).at(0) + 9;
  EXPECT_EQ(number(chunk_index + 16, 8), chunk);
  EXPECT_EQ(number(chunk_index + 24, 8), index - chunk) << "its length";
  EXPECT_EQ(number(chunk_index + 32 + 4 + 2, 8), index);
}

TEST_F(McapWriterTest, CountsInItsStatistics) {
  write_two_messages();
  const std::size_t at = find(0x0B).at(0) + 9;
  EXPECT_EQ(number(at, 8), 2U) << "messages";
  EXPECT_EQ(number(at + 8, 2), 1U) << "schemas";
  EXPECT_EQ(number(at + 10, 4), 1U) << "channels";
  EXPECT_EQ(number(at + 22, 4), 1U) << "chunks";
  EXPECT_EQ(number(at + 26, 8), 20U);
  EXPECT_EQ(number(at + 34, 8), 30U);
}

TEST_F(McapWriterTest, IsWholeWithoutAMessage) {
  McapWriter writer{write(), "test"};
  ASSERT_TRUE(writer.finish());
  EXPECT_TRUE(find(0x06).empty());
  EXPECT_EQ(number(find(0x0B).at(0) + 9, 8), 0U);
}

TEST_F(McapWriterTest, WritesNothingAfterAFailure) {
  int writes = 0;
  McapWriter writer{[&](std::string_view) -> Result<void> {
                      ++writes;
                      return Failure{"the disk is full"};
                    },
                    "test"};
  writer.message(writer.add_channel("/things", 0), 1, "{}");
  EXPECT_EQ(writer.finish().failure().message, "the disk is full");
  EXPECT_EQ(writes, 1);
}

}  // namespace
}  // namespace cargobay::hal
