// Reading recordings: complete, cut off, damaged, or not a recording at all.
#include "hal/recording/recording.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <string_view>

#include <gtest/gtest.h>

#include "hal/recording/replay.hpp"
#include "tests/hal/recorded_drive.hpp"

namespace cargobay::hal {
namespace {

using test::RecordedDrive;
using Bytes = std::vector<std::uint8_t>;

const Bytes& drive() {
  static const Bytes kFile = [] {
    RecordedDrive drive;
    drive.run(60);
    return drive.file();
  }();
  return kFile;
}

std::string complaint_about(const Bytes& file) {
  const auto recording = Recording::read(file);
  return recording ? "" : recording.failure().message;
}

bool says(const std::string& complaint, std::string_view what) {
  return complaint.find(what) != std::string::npos;
}

// The check value of the CRC catalogue.
TEST(Crc32, IsThatOfEthernet) {
  constexpr std::string_view kDigits = "123456789";
  const Bytes bytes{kDigits.begin(), kDigits.end()};
  EXPECT_EQ(crc32(bytes), 0xCBF43926U);
  EXPECT_EQ(crc32(std::span{bytes}.subspan(4), crc32(std::span{bytes}.first(4))), 0xCBF43926U);
}

TEST(ByteReader, TakesShortNumbersStrictly) {
  const auto taken = [](const Bytes& bytes) -> std::optional<std::uint64_t> {
    ByteReader in{bytes};
    std::uint64_t value = 0;
    in.number(value, ~0ULL);
    return in.sound() ? std::optional{value} : std::nullopt;
  };
  EXPECT_EQ(taken({0x00}), 0U);
  EXPECT_EQ(taken({0x7F}), 127U);
  EXPECT_EQ(taken({0x80, 0x01}), 128U);
  EXPECT_EQ(taken({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01}), ~0ULL);
  EXPECT_EQ(taken({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02}), std::nullopt);
  EXPECT_EQ(taken({0x80}), std::nullopt);
  EXPECT_EQ(taken({}), std::nullopt);
}

TEST(RecordingHeader, ComesBackAsItWas) {
  RecordingHeader header{.baud = 19200,
                         .started_ns = 1'800'000'000'000'000'001,
                         .software = "cargobay 1.2.3",
                         .note = "a robot called R\u00f6bi"};
  header.parameters.loop.estimator.remainder = rt::Remainder::lost;
  header.parameters.loop.estimator.likely_lag_s = 0.123;
  header.parameters.loop.schedule.window_ticks = 77;
  header.parameters.loop.feedback = rt::WheelLoop::Feedback::open;
  header.parameters.drive_mode = oi::Mode::full;
  header.parameters.setpoint_lapse = rt::Duration{12345};
  const Bytes bytes = encode(header);
  const auto decoded = decode_header(bytes);
  ASSERT_TRUE(decoded) << decoded.failure().message;
  EXPECT_EQ(decoded->bytes, bytes.size());
  EXPECT_EQ(encode(decoded->header), bytes) << "every field";
  EXPECT_EQ(decoded->header.baud, 19200U);
  EXPECT_EQ(decoded->header.started_ns, header.started_ns);
  EXPECT_EQ(decoded->header.software, header.software);
  EXPECT_EQ(decoded->header.note, header.note);
  EXPECT_EQ(decoded->header.parameters.loop.estimator.remainder, rt::Remainder::lost);
  EXPECT_EQ(decoded->header.parameters.loop.estimator.likely_lag_s, 0.123);
  EXPECT_EQ(decoded->header.parameters.loop.schedule.window_ticks, 77);
  EXPECT_EQ(decoded->header.parameters.loop.feedback, rt::WheelLoop::Feedback::open);
  EXPECT_EQ(decoded->header.parameters.drive_mode, oi::Mode::full);
  EXPECT_EQ(decoded->header.parameters.setpoint_lapse, rt::Duration{12345});
}

TEST(RecordingHeader, RefusesWhatNoCycleIsSetUpWith) {
  const auto refused = [](auto change) {
    RecordingHeader header{.baud = 57600};
    change(header);
    return !decode_header(encode(header));
  };
  EXPECT_FALSE(refused([](RecordingHeader&) {}));
  EXPECT_TRUE(refused([](RecordingHeader& it) { it.baud = 0; }));
  EXPECT_TRUE(
      refused([](RecordingHeader& it) { it.parameters.loop.estimator.likely_lag_s = 0.0; }));
  EXPECT_TRUE(
      refused([](RecordingHeader& it) { it.parameters.loop.controller.overshoot_share = NAN; }));
  EXPECT_TRUE(refused([](RecordingHeader& it) { it.parameters.loop.schedule.probe_reads = -1; }));
  EXPECT_TRUE(refused([](RecordingHeader& it) { it.parameters.stop_after = rt::Duration{-1}; }));
}

TEST(RecordingHeader, CutsLongTexts) {
  const Bytes bytes = encode(RecordingHeader{.baud = 57600, .note = std::string(70'000, 'x')});
  const auto decoded = decode_header(bytes);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->header.note, std::string(1000, 'x'));
}

TEST(RecordingHeader, TellsATerminalNothing) {
  const auto decoded = decode_header(encode(RecordingHeader{.baud = 57600, .note = "a\n\033[2Jb"}));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->header.note, "a??[2Jb");
}

TEST(Recording, IsReadWhole) {
  const auto recording = Recording::read(drive());
  ASSERT_TRUE(recording) << recording.failure().message;
  EXPECT_EQ(recording->header().note, "to and fro");
  EXPECT_EQ(recording->blocks().size(), 62U) << "before the first wait, each frame, the end";
  EXPECT_EQ(recording->unbroken(), 62U);
  EXPECT_EQ(recording->cut_off_bytes(), 0U);
  EXPECT_EQ(recording->missing_blocks(), 0U);
}

TEST(Recording, IsNoneWhereItHasNotTheMagic) {
  EXPECT_TRUE(says(complaint_about({}), "not a recording"));
  EXPECT_TRUE(says(complaint_about({'h', 'e', 'l', 'l', 'o'}), "not a recording"));
  EXPECT_TRUE(says(complaint_about(Bytes(5000, 0)), "not a recording"));
}

TEST(Recording, IsOfThisVersionOnly) {
  Bytes file = drive();
  file[kRecordingMagic.size()] = 9;
  EXPECT_TRUE(says(complaint_about(file), "version 9, and this program reads version 3"));
}

// As if the power had failed at any byte.
TEST(Recording, IsReadUpToTheLastWholeBlock) {
  const auto whole = Recording::read(drive());
  ASSERT_TRUE(whole);
  const std::size_t header = encode(whole->header()).size();
  std::size_t blocks = 0;
  for (std::size_t size = 0; size <= drive().size(); ++size) {
    const Bytes file{drive().begin(), drive().begin() + static_cast<std::ptrdiff_t>(size)};
    const auto recording = Recording::read(file);
    if (size < header) {
      ASSERT_FALSE(recording) << size;
      continue;
    }
    ASSERT_TRUE(recording) << size << ": " << recording.failure().message;
    const std::size_t there = recording->blocks().size();
    EXPECT_TRUE(there == blocks || there == blocks + 1) << size;
    EXPECT_EQ(recording->cut_off_bytes() == 0, size == header || there == blocks + 1) << size;
    blocks = there;
  }
  EXPECT_EQ(blocks, whole->blocks().size());
}

// Wherever a bit flips, it is detected, or the file seems to be cut off.
TEST(Recording, IsNotReadWhereABitHasFlipped) {
  const auto whole = Recording::read(drive());
  ASSERT_TRUE(whole);
  Bytes file = drive();
  for (std::size_t at = 0; at < file.size(); ++at) {
    file[at] ^= static_cast<std::uint8_t>(1U << at % 8);
    const auto recording = Recording::read(file);
    const bool seems_cut = recording && recording->cut_off_bytes() > 0 &&
                           file.size() - at < kMostBlockBytes + kBlockHeadBytes;
    EXPECT_TRUE(!recording || seems_cut) << "at byte " << at;
    file[at] = drive()[at];
  }
}

TEST(Recording, SaysWhereItIsDamaged) {
  const auto whole = Recording::read(drive());
  ASSERT_TRUE(whole);
  Bytes file = drive();
  const Recording::Block& block = whole->blocks()[10];
  const auto entries = static_cast<std::size_t>(block.entries.data() - drive().data());
  file[entries + 5] ^= 0x20;
  const std::string byte = std::to_string(entries - kBlockHeadBytes);
  EXPECT_TRUE(says(complaint_about(file), "is damaged at byte " + byte)) << complaint_about(file);
  EXPECT_TRUE(says(complaint_about(file), "head -c " + byte));
  file.resize(entries - kBlockHeadBytes);
  const auto kept = Recording::read(file);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->blocks().size(), 10U);
}

TEST(Recording, CountsBlocksThatAreMissing) {
  const auto whole = Recording::read(drive());
  ASSERT_TRUE(whole);
  Bytes file = drive();
  const auto begin = [&](std::size_t index) {
    return file.begin() + (whole->blocks()[index].entries.data() - drive().data()) -
           kBlockHeadBytes;
  };
  file.erase(begin(10), begin(13));
  const auto recording = Recording::read(file);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->missing_blocks(), 3U);
  EXPECT_EQ(recording->unbroken(), 10U);
  const auto result = replay(*recording);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->difference);
  EXPECT_EQ(result->frames, 9U);
}

TEST(Recording, RefusesBlocksOutOfOrder) {
  const auto whole = Recording::read(drive());
  ASSERT_TRUE(whole);
  Bytes file = drive();
  const std::ptrdiff_t last = whole->blocks().back().entries.data() - drive().data() -
                              static_cast<std::ptrdiff_t>(kBlockHeadBytes);
  file.insert(file.end(), drive().begin() + last, drive().end());
  EXPECT_TRUE(says(complaint_about(file), "out of order"));
}

// Whatever a block claims about itself, with a correct checksum.
TEST(Recording, TrustsNoLength) {
  std::mt19937 random{3};
  const Bytes header = encode(RecordingHeader{.baud = 57600});
  for (int i = 0; i < 20'000; ++i) {
    FlightRecorder::Block block;
    block.entries.resize(random() % 40);
    for (std::uint8_t& byte : block.entries) byte = static_cast<std::uint8_t>(random() % 9);
    Bytes file = header;
    std::ranges::copy(encode(block), std::back_inserter(file));
    const auto recording = Recording::read(file);
    if (recording) {
      EXPECT_TRUE(replay(*recording));
    }
  }
}

}  // namespace
}  // namespace cargobay::hal
