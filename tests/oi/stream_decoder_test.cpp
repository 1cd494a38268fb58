#include "oi/stream_decoder.hpp"

#include <algorithm>
#include <array>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "oi/sensors.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {
namespace {

using Outcome = StreamDecoder::Outcome;
using testing::ElementsAre;
using testing::IsEmpty;

// OI p. 14, the answer to Stream 29 13: as in the manual, and as robots send it.
const Bytes kManualFrame{19, 5, 29, 2, 25, 13, 0, 182};
const Bytes kRobotFrame{19, 5, 29, 2, 25, 13, 0, 163};
// Distance, angle, mode: what the control loop streams. The 19 after the length is an id.
const Bytes kLoopFrame = frame_around({19, 0, 1, 20, 0, 0, 35, 2});

constexpr bool decodes(std::span<const std::uint8_t> bytes, Checksum form) {
  StreamDecoder decoder{form};
  Outcome outcome = Outcome::nothing;
  for (const std::uint8_t byte : bytes) outcome = decoder.push(byte);
  return outcome == Outcome::frame && std::ranges::equal(decoder.frame(), bytes);
}
constexpr std::array<std::uint8_t, 8> kAtCompileTime{19, 5, 29, 2, 25, 13, 0, 163};
static_assert(decodes(kAtCompileTime, Checksum::automatic));
static_assert(decodes(kAtCompileTime, Checksum::including_header));
static_assert(!decodes(kAtCompileTime, Checksum::excluding_header));

TEST(StreamDecoder, DecodesTheManualsFrameByEitherChecksum) {
  EXPECT_TRUE(decodes(kManualFrame, Checksum::automatic));
  EXPECT_TRUE(decodes(kManualFrame, Checksum::excluding_header));
  EXPECT_FALSE(decodes(kManualFrame, Checksum::including_header));
  EXPECT_TRUE(decodes(kRobotFrame, Checksum::automatic));
  EXPECT_TRUE(decodes(kRobotFrame, Checksum::including_header));
  EXPECT_FALSE(decodes(kRobotFrame, Checksum::excluding_header));
}

TEST(StreamDecoder, SaysNothingWithinAFrame) {
  StreamDecoder decoder;
  for (std::size_t i = 0; i + 1 < kRobotFrame.size(); ++i) {
    EXPECT_EQ(decoder.push(kRobotFrame[i]), Outcome::nothing) << "byte " << i;
  }
  EXPECT_EQ(decoder.push(kRobotFrame.back()), Outcome::frame);
  EXPECT_EQ(decoder.next(), Outcome::nothing);
}

TEST(StreamDecoder, DecodesAFrameWhoseChecksumIsZero) {
  // 19 + 2 + 22... the data are chosen such that the rest of the sum is 0 already.
  for (const Checksum form : {Checksum::including_header, Checksum::excluding_header}) {
    const int header = form == Checksum::including_header ? 19 : 0;
    const Bytes frame = frame_around({17, static_cast<std::uint8_t>(256 - header - 2 - 17)}, form);
    ASSERT_EQ(frame.back(), 0);
    for (const Checksum decoder_form : {form, Checksum::automatic}) {
      StreamDecoder decoder{decoder_form};
      EXPECT_THAT(feed(decoder, frame + frame + frame), ElementsAre(frame, frame, frame));
    }
  }
}

TEST(StreamDecoder, DecodesTheLongestFrame) {
  // 4 * 53 + 13 * 3 + 2 * 2 = 255: group 6 four times, thirteen words, two bytes, each with its id.
  Bytes items;
  for (int i = 0; i < 4; ++i) {
    items.push_back(6);
    items.resize(items.size() + 52, static_cast<std::uint8_t>(i));
  }
  for (int i = 0; i < 13; ++i) items = items + Bytes{22, 0x40, 0x41};
  items = items + Bytes{35, 2, 8, 1};
  ASSERT_EQ(items.size(), 255U);
  const Bytes frame = frame_around(items);
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, frame + frame), ElementsAre(frame, frame));
}

TEST(StreamDecoder, DecodesTheShortestFrame) {
  const Bytes frame = frame_around({35, 2});
  ASSERT_EQ(frame.size(), kMinFrameBytes);
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, frame + frame), ElementsAre(frame, frame));
}

TEST(StreamDecoder, KeepsATruncatedFrameUntilItIsRefuted) {
  StreamDecoder decoder;
  const Bytes cut(kLoopFrame.begin(), kLoopFrame.end() - 3);
  EXPECT_THAT(feed(decoder, cut), IsEmpty());
  EXPECT_THAT(feed(decoder, kLoopFrame), ElementsAre(kLoopFrame));
  EXPECT_EQ(decoder.counters().frames, 1U);
  EXPECT_EQ(decoder.counters().skipped, cut.size());
}

TEST(StreamDecoder, RefusesEverySingleFlippedBit) {
  for (std::size_t i = 0; i < kLoopFrame.size(); ++i) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes damaged = kLoopFrame;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (1U << bit));
      StreamDecoder decoder{Checksum::including_header};
      EXPECT_THAT(feed(decoder, damaged), IsEmpty()) << "byte " << i << " bit " << bit;
    }
  }
}

TEST(StreamDecoder, DeliversTheGoodFrameRightBehindACorruptOne) {
  Bytes damaged = kLoopFrame;
  damaged[4] = static_cast<std::uint8_t>(damaged[4] + 1);
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, kLoopFrame + damaged + kLoopFrame),
              ElementsAre(kLoopFrame, kLoopFrame));
  EXPECT_EQ(decoder.counters().bad_checksum, 1U);
  EXPECT_EQ(decoder.counters().resyncs, 2U);
}

TEST(StreamDecoder, SaysCorruptWhereTheChecksumIsWrong) {
  StreamDecoder decoder;
  Outcome outcome = Outcome::nothing;
  for (const std::uint8_t byte : Bytes{19, 5, 29, 2, 25, 13, 0, 164}) outcome = decoder.push(byte);
  EXPECT_EQ(outcome, Outcome::corrupt);
}

TEST(StreamDecoder, ResyncsAfterLostByte) {
  for (std::size_t lost = 0; lost < kLoopFrame.size(); ++lost) {
    Bytes damaged = kLoopFrame;
    damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(lost));
    StreamDecoder decoder;
    const auto frames = feed(decoder, kLoopFrame + damaged + kLoopFrame + kLoopFrame);
    EXPECT_THAT(frames, ElementsAre(kLoopFrame, kLoopFrame, kLoopFrame)) << "lost " << lost;
  }
}

TEST(StreamDecoder, ResyncsAfterInsertedByte) {
  for (std::size_t at = 0; at <= kLoopFrame.size(); ++at) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      Bytes damaged = kLoopFrame;
      damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(at),
                     static_cast<std::uint8_t>(byte));
      StreamDecoder decoder{Checksum::including_header};
      const auto frames = feed(decoder, kLoopFrame + damaged + kLoopFrame + kLoopFrame);
      ASSERT_GE(frames.size(), 3U) << "byte " << byte << " at " << at;
      EXPECT_EQ(frames.back(), kLoopFrame) << "byte " << byte << " at " << at;
    }
  }
}

TEST(StreamDecoder, FindsSeveralFramesInTheBytesOfAFalseCandidate) {
  // A candidate of 258 bytes that only its checksum refutes; inside it are only good frames, none
  // of which directly follows another.
  const Bytes item = Bytes{6} + Bytes(52, 0);
  Bytes items = item + item + item + item + Bytes{22, 1, 1};
  items.resize(255 - 40);
  while (items.size() < 254) items = items + Bytes{35, 0};
  const Bytes inner = frame_around({35, 2});
  std::ranges::copy(inner, items.begin() + 10);
  std::ranges::copy(inner, items.begin() + 20);
  std::ranges::copy(inner, items.begin() + 30);
  Bytes outer = frame_around(items);
  outer.back() = static_cast<std::uint8_t>(outer.back() + 1);
  StreamDecoder decoder{Checksum::including_header};
  EXPECT_THAT(feed(decoder, outer), ElementsAre(inner, inner, inner));
}

TEST(StreamDecoder, DropsAnOpenCandidateWhenTwoFramesWentByInside) {
  // 19 254 6: opens a frame that would swallow at least the next 50 bytes.
  const Bytes opening{19, 254, 6};
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, kLoopFrame + opening + kLoopFrame + kLoopFrame),
              ElementsAre(kLoopFrame, kLoopFrame, kLoopFrame));
  EXPECT_EQ(decoder.counters().overtaken, 1U);
  EXPECT_THAT(feed(decoder, kLoopFrame), ElementsAre(kLoopFrame));
}

TEST(StreamDecoder, DoesNotTakeOneFrameInsideAnotherForATurnOfEvents) {
  const Bytes inner = frame_around({35, 2});
  Bytes items = Bytes{6} + Bytes(52, 1);
  std::ranges::copy(inner, items.begin() + 7);
  const Bytes outer = frame_around(items);
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, outer + outer + outer), ElementsAre(outer, outer, outer));
}

TEST(StreamDecoder, DropsACutFrameOfTheUsualLengthWhenTwoShorterOnesWentByInside) {
  const Bytes big = frame_around(Bytes{6} + Bytes(52, 1));
  const Bytes small = frame_around({35, 2});
  StreamDecoder decoder;
  ASSERT_EQ(feed(decoder, big + big + big + big + big).size(), 5U);
  const Bytes cut(big.begin(), big.begin() + 10);
  EXPECT_THAT(feed(decoder, cut + small + small), ElementsAre(small, small));
}

// The usual length is also the value of the header: a duplicated 19 opens a candidate of the usual
// length, and the second 19 is the header of the first frame inside it.
TEST(StreamDecoder, DropsADoubledHeaderThatLooksLikeTheUsualLengthWhenTwoFramesWentByInside) {
  const Bytes usual = frame_around({22, 1, 2, 22, 3, 4, 22, 5, 6, 22, 7, 8, 22, 9, 1, 35, 2, 7, 0});
  ASSERT_EQ(usual.size(), kFrameHeader + kFrameOverhead);
  const Bytes shorter = frame_around({35, 2});
  StreamDecoder decoder{Checksum::including_header};
  EXPECT_THAT(feed(decoder, usual + shorter), ElementsAre(usual, shorter));
  feed(decoder, {kFrameHeader});
  feed(decoder, shorter);
  EXPECT_THAT(feed(decoder, shorter), ElementsAre(shorter, shorter));
}

TEST(StreamDecoder, FollowsAListThatChangesWithEveryFrame) {
  const Bytes small = frame_around({35, 2});
  StreamDecoder decoder;
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(feed(decoder, kLoopFrame), ElementsAre(kLoopFrame));
    EXPECT_THAT(feed(decoder, small), ElementsAre(small));
  }
  EXPECT_EQ(decoder.counters().skipped, 0U);
  EXPECT_EQ(decoder.counters().resyncs, 1U);
}

TEST(StreamDecoder, RefusesStructureEarly) {
  const std::array<Bytes, 5> wrong{{
      {19, 0},       // no packets
      {19, 1},       // an id without data
      {19, 5, 43},   // not a packet
      {19, 5, 255},  // not a packet
      {19, 2, 19},   // data beyond the length
  }};
  for (const Bytes& bytes : wrong) {
    StreamDecoder decoder;
    Outcome outcome = Outcome::nothing;
    for (const std::uint8_t byte : bytes) outcome = decoder.push(byte);
    EXPECT_EQ(outcome, Outcome::corrupt) << testing::PrintToString(bytes);
    EXPECT_EQ(decoder.counters().bad_structure, 1U);
  }
}

TEST(StreamDecoder, RefusesWrongStructureThoughLengthAndChecksumAreAsBefore) {
  StreamDecoder decoder{Checksum::including_header};
  ASSERT_EQ(feed(decoder, kLoopFrame + kLoopFrame).size(), 2U);
  EXPECT_THAT(feed(decoder, frame_around({19, 0, 1, 43, 0, 0, 35, 2})), IsEmpty());
  EXPECT_EQ(decoder.counters().bad_structure, 2U);  // the frame, and its id 19 read as a header
}

TEST(StreamDecoder, KnowsThePacketsOutsideTheManualOnlyWhenAsked) {
  const Bytes frame = frame_around({43, 1, 2, 44, 3, 4});
  StreamDecoder plain;
  EXPECT_THAT(feed(plain, frame), IsEmpty());
  StreamDecoder extended{Checksum::automatic, kCreateWithExtensions};
  EXPECT_THAT(feed(extended, frame), ElementsAre(frame));
  extended.reset();
  EXPECT_THAT(feed(extended, frame), ElementsAre(frame));
}

TEST(StreamDecoder, SettlesOnTheFormOfFourFramesInARow) {
  for (const auto& [frame, form] : {std::pair{kManualFrame, Checksum::excluding_header},
                                    std::pair{kRobotFrame, Checksum::including_header}}) {
    StreamDecoder decoder;
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(decoder.checksum(), std::nullopt);
      EXPECT_THAT(feed(decoder, frame), ElementsAre(frame));
    }
    EXPECT_EQ(decoder.checksum(), form);
    EXPECT_EQ(decoder.counters().locks, 1U);
  }
}

TEST(StreamDecoder, RefusesTheOtherFormOnceSettled) {
  StreamDecoder decoder;
  (void)feed(decoder, kRobotFrame + kRobotFrame + kRobotFrame + kRobotFrame);
  EXPECT_THAT(feed(decoder, kManualFrame), IsEmpty());
  EXPECT_THAT(feed(decoder, kRobotFrame), ElementsAre(kRobotFrame));
}

TEST(StreamDecoder, SettlesAgainWhenFourFramesInARowHaveTheOtherForm) {
  StreamDecoder decoder;
  (void)feed(decoder, kRobotFrame + kRobotFrame + kRobotFrame + kRobotFrame);
  EXPECT_THAT(feed(decoder, kManualFrame + kManualFrame + kManualFrame), IsEmpty());
  EXPECT_EQ(decoder.checksum(), Checksum::including_header);
  EXPECT_THAT(feed(decoder, kManualFrame), ElementsAre(kManualFrame));
  EXPECT_EQ(decoder.checksum(), Checksum::excluding_header);
  EXPECT_THAT(feed(decoder, kManualFrame), ElementsAre(kManualFrame));
}

TEST(StreamDecoder, SettlesAgainThoughTheFramesAreFullOfFalseHeaders) {
  const Bytes items{19, 0xff, 19, 20, 0xff, 19, 35, 2};
  const Bytes robot = frame_around(items, Checksum::including_header);
  const Bytes manual = frame_around(items, Checksum::excluding_header);
  StreamDecoder decoder;
  ASSERT_EQ(feed(decoder, robot + robot + robot + robot + robot).size(), 5U);
  Bytes many;
  for (int i = 0; i < 12; ++i) many = many + manual;
  EXPECT_GE(feed(decoder, many).size(), 7U);
  EXPECT_EQ(decoder.checksum(), Checksum::excluding_header);
}

TEST(StreamDecoder, IsNotTalkedIntoTheOtherFormByFramesApart) {
  StreamDecoder decoder;
  (void)feed(decoder, kRobotFrame + kRobotFrame + kRobotFrame + kRobotFrame);
  for (int i = 0; i < 20; ++i) EXPECT_THAT(feed(decoder, kManualFrame + Bytes{0}), IsEmpty());
  EXPECT_EQ(decoder.checksum(), Checksum::including_header);
}

TEST(StreamDecoder, PassesOverTextAndCountsIt) {
  const Bytes chatter = text("bat:   min 0  sec 57  mV 16894  mA 1270  deg-C 11\r\n");
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, chatter + kLoopFrame + chatter + kLoopFrame),
              ElementsAre(kLoopFrame, kLoopFrame));
  EXPECT_EQ(decoder.counters().text, 2 * chatter.size());
  EXPECT_EQ(decoder.counters().skipped, 2 * chatter.size());
  EXPECT_EQ(decoder.counters().bad_checksum + decoder.counters().bad_structure, 0U);
}

TEST(StreamDecoder, CountsOtherBytesAsSkippedButNotAsText) {
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, {0, 7, 0x7f, 0x80, 255}), IsEmpty());
  EXPECT_EQ(decoder.counters().skipped, 5U);
  EXPECT_EQ(decoder.counters().text, 0U);
}

TEST(StreamDecoder, HandsOverTheTextItSkipped) {
  TextTail tail;
  StreamDecoder decoder;
  decoder.collect_text(&tail);
  (void)feed(decoder, text("key-wa") + kLoopFrame + text("keup\n") + Bytes{1, 2});
  std::array<char, 64> characters{};
  const std::size_t count = tail.copy(characters);
  EXPECT_EQ(std::string(characters.data(), count), "key-wakeup\n");
}

TEST(StreamDecoder, GivesUpAnOpenCandidateWhenTheLineIsQuiet) {
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, Bytes{19, 254, 6} + kLoopFrame), IsEmpty());
  std::vector<Bytes> frames;
  Outcome outcome = Outcome::nothing;
  while ((outcome = decoder.abandon()) != Outcome::nothing) {
    if (outcome == Outcome::frame)
      frames.emplace_back(decoder.frame().begin(), decoder.frame().end());
  }
  EXPECT_THAT(frames, ElementsAre(kLoopFrame));
  EXPECT_EQ(decoder.counters().skipped, 3U);
  EXPECT_THAT(feed(decoder, kLoopFrame), ElementsAre(kLoopFrame));
}

// A frame without another 19 in it, inside a candidate that has not failed yet.
TEST(StreamDecoder, FindsTheOnlyFrameInsideACandidateThatItGivesUp) {
  const Bytes frame{19, 13, 35, 0, 2, 0, 0, 0, 0, 0, 0, 7, 0, 34, 0, 146};
  StreamDecoder decoder;
  EXPECT_THAT(feed(decoder, Bytes{19, 40} + frame), IsEmpty());
  EXPECT_EQ(decoder.abandon(), Outcome::corrupt);
  EXPECT_EQ(decoder.abandon(), Outcome::frame);
  EXPECT_EQ(Bytes(decoder.frame().begin(), decoder.frame().end()), frame);
  EXPECT_EQ(decoder.abandon(), Outcome::nothing);
  EXPECT_EQ(decoder.counters().skipped, 2U);
}

TEST(StreamDecoder, GivesUpHalfAFrameOfTheUsualLength) {
  StreamDecoder decoder{Checksum::including_header};
  (void)feed(decoder, kLoopFrame + Bytes(kLoopFrame.begin(), kLoopFrame.begin() + 6));
  while (decoder.abandon() != Outcome::nothing) {
  }
  EXPECT_EQ(decoder.counters().skipped, 6U);
  EXPECT_THAT(feed(decoder, kLoopFrame), ElementsAre(kLoopFrame));
  while (decoder.abandon() != Outcome::nothing) {
  }
  EXPECT_EQ(decoder.counters().skipped, 6U);
}

TEST(StreamDecoder, LosesNoFrameOfACallerWhoNeverCallsNext) {
  StreamDecoder decoder;
  Bytes bytes = Bytes{19, 254, 6};
  for (int i = 0; i < 200; ++i)
    bytes = bytes + kLoopFrame + (i % 50 == 0 ? Bytes{19, 19, 2} : Bytes{});
  for (const std::uint8_t byte : bytes) (void)decoder.push(byte);
  EXPECT_GE(decoder.counters().frames, 190U);
}

TEST(StreamDecoder, IsAsNewAfterReset) {
  StreamDecoder decoder;
  (void)feed(decoder, kRobotFrame + kRobotFrame + kRobotFrame + kRobotFrame + Bytes{19, 254, 6});
  decoder.reset();
  EXPECT_EQ(decoder.counters().bytes, 0U);
  EXPECT_EQ(decoder.checksum(), std::nullopt);
  EXPECT_THAT(feed(decoder, kManualFrame), ElementsAre(kManualFrame));
}

TEST(StreamDecoder, AccountsForEveryByte) {
  StreamDecoder decoder;
  (void)feed(decoder, Bytes{1, 2, 19, 19} + kLoopFrame + text("hello") + kLoopFrame + Bytes{19});
  while (decoder.abandon() != Outcome::nothing) {
  }
  const StreamDecoder::Counters& counters = decoder.counters();
  EXPECT_EQ(counters.bytes, counters.framed + counters.skipped);
  EXPECT_EQ(counters.framed, 2 * kLoopFrame.size());
}

}  // namespace
}  // namespace cargobay::oi
