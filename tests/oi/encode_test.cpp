#include "oi/encode.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "oi/command.hpp"
#include "oi/parse.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {
namespace {

// Both directions at once: the manual's bytes from the command, and the command from the bytes.
template <typename C>
void expect_both_ways(const C& command, const Bytes& bytes) {
  const auto encoded = encode(command);
  ASSERT_TRUE(encoded.has_value());
  EXPECT_EQ(Bytes(encoded->begin(), encoded->end()), bytes);
  EXPECT_EQ(parse<C>(bytes), command);
  const ParseResult result = parse_command(bytes);
  ASSERT_EQ(result.outcome, ParseResult::Outcome::command);
  EXPECT_EQ(result.command, Command{command});
  EXPECT_EQ(result.length, bytes.size());
  const auto any = encode(result.command);
  ASSERT_TRUE(any.has_value());
  EXPECT_EQ(Bytes(any->begin(), any->end()), bytes);
}

static_assert(encode(Start{})->size() == 1);
static_assert(*parse<Drive>(*encode(Drive{MmPerSec{-200}, Mm{500}})) ==
              Drive{MmPerSec{-200}, Mm{500}});

TEST(ManualExample, Drive) {  // OI p. 9
  expect_both_ways(Drive{MmPerSec{-200}, Mm{500}}, {137, 255, 56, 1, 244});
}
TEST(ManualExample, Leds) {  // OI p. 9
  expect_both_ways(Leds{BitSet<Led>{}.with(Led::advance), 0, 128}, {139, 8, 0, 128});
}
TEST(ManualExample, LowSideDrivers) {  // OI p. 10
  expect_both_ways(LowSideDrivers{BitSet<LowSideDriver>{}.with(LowSideDriver::driver_1)}, {138, 2});
}
TEST(ManualExample, PwmLowSideDrivers) {  // OI p. 10
  expect_both_ways(PwmLowSideDrivers{.driver_0 = 128, .driver_1 = 0, .driver_2 = 32},
                   {144, 32, 0, 128});
}
TEST(ManualExample, QueryList) {  // OI p. 13
  expect_both_ways(
      QueryList{list_of<PacketId, kMaxQueryPackets>(PacketId::cliff_left, PacketId::virtual_wall)},
      {149, 2, 9, 13});
}
TEST(ManualExample, Stream) {  // OI p. 14
  expect_both_ways(Stream{list_of<PacketId, kMaxStreamPackets>(PacketId::cliff_front_left_signal,
                                                               PacketId::virtual_wall)},
                   {148, 2, 29, 13});
}
TEST(ManualExample, WaitEvent) {  // OI p. 16
  expect_both_ways(WaitEvent{inverse(ScriptEvent::bump)}, {158, 251});
}
TEST(ManualExample, ScriptDrive40CmAndStop) {  // OI p. 15
  const Bytes bytes{152, 13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0};
  Script script;
  ASSERT_TRUE(script.body.append(std::span{bytes}.subspan(2)));
  expect_both_ways(script, bytes);
}
TEST(ManualExample, ScriptToggleLedOnBump) {  // OI p. 15
  const Bytes bytes{152, 17, 158, 5, 158, 251, 139, 2, 0, 0, 158, 5, 158, 251, 139, 0, 0, 0, 153};
  Script script;
  ASSERT_TRUE(script.body.append(std::span{bytes}.subspan(2)));
  expect_both_ways(script, bytes);
}
TEST(ManualExample, ScriptDriveInASquare) {  // OI p. 15
  const Bytes bytes{152, 17, 137, 1, 44, 128, 0, 156, 1, 144, 137, 1, 44, 0, 1, 157, 0, 90, 153};
  Script script;
  ASSERT_TRUE(script.body.append(std::span{bytes}.subspan(2)));
  expect_both_ways(script, bytes);
}

TEST(Encode, SendsRightBeforeLeft) {
  expect_both_ways(DriveDirect{.left = MmPerSec{100}, .right = MmPerSec{-100}},
                   {145, 0xff, 0x9c, 0x00, 0x64});
}
TEST(Encode, SendsTheSpecialRadii) {
  expect_both_ways(Drive{MmPerSec{500}, kStraight}, {137, 1, 244, 0x80, 0});
  expect_both_ways(Drive{MmPerSec{500}, kStraightAlternative}, {137, 1, 244, 0x7f, 0xff});
  expect_both_ways(Drive{MmPerSec{500}, kTurnClockwise}, {137, 1, 244, 0xff, 0xff});
  expect_both_ways(Drive{MmPerSec{500}, kTurnCounterClockwise}, {137, 1, 244, 0, 1});
  EXPECT_EQ(Drive{}.radius, kStraight);
}
TEST(Encode, SendsMinusOneToAbortADemo) { expect_both_ways(Demo{DemoNumber::abort}, {136, 255}); }
TEST(Encode, SendsALengthOfZeroToClearTheScript) { expect_both_ways(Script{}, {152, 0}); }
TEST(Encode, SendsRestsInSongs) {
  Song song{.slot = 3};
  for (const std::uint8_t number : Bytes{0, 30, 31, 127, 128, 255}) {
    ASSERT_TRUE(song.notes.push_back({number, SixtyFourths{32}}));
  }
  expect_both_ways(song, {140, 3, 6, 0, 32, 30, 32, 31, 32, 127, 32, 128, 32, 255, 32});
}
TEST(Encode, SendsTheCommandsWithoutArguments) {
  expect_both_ways(Start{}, {128});
  expect_both_ways(Control{}, {130});
  expect_both_ways(Safe{}, {131});
  expect_both_ways(Full{}, {132});
  expect_both_ways(Spot{}, {134});
  expect_both_ways(Cover{}, {135});
  expect_both_ways(CoverAndDock{}, {143});
  expect_both_ways(PlayScript{}, {153});
  expect_both_ways(ShowScript{}, {154});
}
TEST(Encode, SendsTheRest) {
  expect_both_ways(Baud{10}, {129, 10});
  expect_both_ways(Play{15}, {141, 15});
  expect_both_ways(Sensors{PacketId::group_6}, {142, 6});
  expect_both_ways(DigitalOutputs{BitSet<DigitalOutput>{5}}, {147, 5});
  expect_both_ways(Stream{}, {148, 0});
  expect_both_ways(PauseResumeStream{StreamState::resume}, {150, 1});
  expect_both_ways(SendIr{255}, {151, 255});
  expect_both_ways(WaitTime{Tenths{255}}, {155, 255});
  expect_both_ways(WaitDistance{Mm{-32768}}, {156, 0x80, 0});
  expect_both_ways(WaitAngle{Deg{32767}}, {157, 0x7f, 0xff});
}

// Refused, never clamped.
TEST(Encode, RefusesWhatIsOutOfRange) {
  EXPECT_FALSE(encode(DriveDirect{.left = MmPerSec{501}, .right = MmPerSec{0}}));
  EXPECT_FALSE(encode(DriveDirect{.left = MmPerSec{0}, .right = MmPerSec{-501}}));
  EXPECT_FALSE(encode(Drive{MmPerSec{0}, Mm{2001}}));
  EXPECT_FALSE(encode(Drive{MmPerSec{0}, Mm{-32767}}));
  EXPECT_FALSE(encode(Drive{MmPerSec{65536}, kStraight}));
  EXPECT_FALSE(encode(Baud{12}));
  EXPECT_FALSE(encode(Demo{DemoNumber{10}}));
  EXPECT_FALSE(encode(Demo{DemoNumber{-2}}));
  EXPECT_FALSE(encode(LowSideDrivers{BitSet<LowSideDriver>{8}}));
  EXPECT_FALSE(encode(Leds{BitSet<Led>{1}, 0, 0}));
  EXPECT_FALSE(encode(Song{.slot = 0}));  // without notes
  EXPECT_FALSE(
      encode(Song{.slot = 16, .notes = list_of<Note, kMaxSongNotes>(Note{60, SixtyFourths{1}})}));
  EXPECT_FALSE(
      encode(Song{.slot = 0, .notes = list_of<Note, kMaxSongNotes>(Note{60, SixtyFourths{256}})}));
  EXPECT_FALSE(
      encode(Song{.slot = 0, .notes = list_of<Note, kMaxSongNotes>(Note{60, SixtyFourths{-1}})}));
  EXPECT_FALSE(encode(Play{16}));
  EXPECT_FALSE(encode(Sensors{PacketId{43}}));
  EXPECT_FALSE(encode(PwmLowSideDrivers{.driver_0 = 129}));
  EXPECT_FALSE(encode(DigitalOutputs{BitSet<DigitalOutput>{8}}));
  EXPECT_FALSE(encode(Stream{list_of<PacketId, kMaxStreamPackets>(PacketId{43})}));
  EXPECT_FALSE(encode(PauseResumeStream{StreamState{2}}));
  EXPECT_FALSE(encode(WaitTime{Tenths{256}}));
  EXPECT_FALSE(encode(WaitTime{Tenths{-1}}));
  EXPECT_FALSE(encode(WaitDistance{Mm{32768}}));
  EXPECT_FALSE(encode(WaitAngle{Deg{-32769}}));
  EXPECT_FALSE(encode(WaitEvent{ScriptEvent{0}}));
  EXPECT_FALSE(encode(WaitEvent{ScriptEvent{23}}));
  EXPECT_FALSE(encode(Command{WaitEvent{ScriptEvent{-23}}}));
}

TEST(Encode, HasRoomForTheLongestOfEach) {
  EXPECT_EQ(EncodedCommand<Start>::capacity(), 1U);
  EXPECT_EQ(EncodedCommand<DriveDirect>::capacity(), 5U);
  EXPECT_EQ(EncodedCommand<Song>::capacity(), 35U);
  EXPECT_EQ(EncodedCommand<Stream>::capacity(), 45U);
  EXPECT_EQ(EncodedCommand<QueryList>::capacity(), 257U);
  EXPECT_EQ(EncodedCommand<Script>::capacity(), 102U);
}

}  // namespace
}  // namespace cargobay::oi
