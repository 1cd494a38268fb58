#include "oi/text/song.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "oi/encode.hpp"

namespace cargobay::oi {
namespace {

TEST(NoteNames, FollowTheManualsTable) {
  EXPECT_EQ(find_note("g1"), 31);
  EXPECT_EQ(find_note("c2"), 36);
  EXPECT_EQ(find_note("c4"), 60);
  EXPECT_EQ(find_note("c#4"), 61);
  EXPECT_EQ(find_note("a4"), 69);
  EXPECT_EQ(find_note("b6"), 95);
  EXPECT_EQ(find_note("c7"), 96);
  EXPECT_EQ(find_note("g9"), 127);
}

TEST(NoteNames, ReadFlatsAndEitherCase) {
  EXPECT_EQ(find_note("db4"), 61);
  EXPECT_EQ(find_note("Db4"), 61);
  EXPECT_EQ(find_note("BB4"), 70);
  EXPECT_EQ(find_note("bb4"), 70);
  EXPECT_EQ(find_note("F#3"), 54);
  EXPECT_EQ(find_note("e#4"), 65);
  EXPECT_EQ(find_note("fb4"), 64);
}

TEST(NoteNames, KeepTheOctaveOfTheLetter) {
  EXPECT_EQ(find_note("cb5"), find_note("b4"));
  EXPECT_EQ(find_note("b#4"), find_note("c5"));
}

TEST(NoteNames, ReadARest) {
  for (const std::string_view name : {"rest", "Rest", "REST"}) EXPECT_EQ(find_note(name), kRest);
  EXPECT_TRUE(is_rest(kRest));
}

TEST(NoteNames, RefuseWhatTheRobotWouldNotSound) {
  EXPECT_EQ(find_note("f#1"), std::nullopt);
  EXPECT_EQ(find_note("gb1"), std::nullopt);
  EXPECT_EQ(find_note("g#9"), std::nullopt);
  EXPECT_EQ(find_note("ab9"), std::nullopt);
  EXPECT_EQ(find_note("c0"), std::nullopt);
}

TEST(NoteNames, RefuseWhatIsNoName) {
  for (const std::string_view name : {"", "c", "4", "h4", "c44", "c##4", "#4", "c4 ", " c4", "cb",
                                      "c#", "res", "rests", "60", "c-1", "cb-", "\303\2514"}) {
    EXPECT_EQ(find_note(name), std::nullopt) << name;
  }
  EXPECT_EQ(find_note(std::string_view{"c\0"
                                       "4",
                                       3}),
            std::nullopt);
}

TEST(NoteNames, RoundTripForEveryNumber) {
  for (unsigned number = 0; number < 256; ++number) {
    const auto byte = static_cast<std::uint8_t>(number);
    const NoteName name = note_name(byte);
    const auto found = find_note(name.view());
    ASSERT_TRUE(found) << number;
    EXPECT_EQ(is_rest(byte), number < 31 || number > 127);
    EXPECT_EQ(name.view() == "rest", is_rest(byte));
    EXPECT_EQ(*found, is_rest(byte) ? kRest : byte);
  }
}

TEST(NoteNames, AreWrittenWithSharps) {
  EXPECT_EQ(note_name(31).view(), "g1");
  EXPECT_EQ(note_name(60).view(), "c4");
  EXPECT_EQ(note_name(61).view(), "c#4");
  EXPECT_EQ(note_name(70).view(), "a#4");
  EXPECT_EQ(note_name(127).view(), "g9");
  EXPECT_EQ(note_name(0).view(), "rest");
}

std::vector<Note> notes(std::size_t count) {
  std::vector<Note> all;
  all.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    all.push_back(
        {static_cast<std::uint8_t>(31 + i % 97), SixtyFourths{static_cast<std::int32_t>(i % 256)}});
  }
  return all;
}

TEST(SplitSong, MakesNoSongOfNoNotes) {
  const auto songs = split({});
  ASSERT_TRUE(songs);
  EXPECT_TRUE(songs->empty());
}

// The notes come out in order, in consecutive slots, and every song can be sent.
TEST(SplitSong, KeepsEveryNoteForEveryLength) {
  for (std::size_t count = 1; count <= kMaxTuneNotes; ++count) {
    const std::vector<Note> all = notes(count);
    const auto songs = split(all);
    ASSERT_TRUE(songs) << count;
    EXPECT_EQ(songs->size(), (count + 15) / 16);
    std::vector<Note> rejoined;
    std::uint8_t slot = 0;
    for (const Song& song : *songs) {
      EXPECT_EQ(song.slot, slot++);
      EXPECT_TRUE(encode(song));
      rejoined.insert(rejoined.end(), song.notes.begin(), song.notes.end());
    }
    EXPECT_EQ(rejoined, all);
  }
}

TEST(SplitSong, RefusesMoreThanAllSlotsHold) {
  EXPECT_TRUE(split(notes(256)));
  EXPECT_FALSE(split(notes(257)));
}

TEST(SplitSong, BeginsAtTheSlotAskedFor) {
  const auto songs = split(notes(17), 14);
  ASSERT_TRUE(songs);
  ASSERT_EQ(songs->size(), 2U);
  EXPECT_EQ((*songs)[0].slot, 14);
  EXPECT_EQ((*songs)[0].notes.size(), 16U);
  EXPECT_EQ((*songs)[1].slot, 15);
  EXPECT_EQ((*songs)[1].notes.size(), 1U);
}

TEST(SplitSong, RefusesSlotsBeyondTheLast) {
  EXPECT_TRUE(split(notes(32), 14));
  EXPECT_FALSE(split(notes(33), 14));
  EXPECT_FALSE(split(notes(1), 16));
  EXPECT_FALSE(split(notes(1), 255));
}

TEST(SongDuration, AddsUp) {
  EXPECT_EQ(duration({}), SixtyFourths{0});
  const std::vector<Note> all{
      {60, SixtyFourths{32}}, {0, SixtyFourths{1}}, {62, SixtyFourths{255}}};
  EXPECT_EQ(duration(all), SixtyFourths{288});
  constexpr std::array<Note, 2> two{{{60, SixtyFourths{32}}, {64, SixtyFourths{32}}}};
  static_assert(duration(two) == SixtyFourths{64});
}

}  // namespace
}  // namespace cargobay::oi
