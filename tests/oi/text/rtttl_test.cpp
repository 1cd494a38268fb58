#include "oi/text/rtttl.hpp"

#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::oi {
namespace {

// The notes as `c4:32 rest:8`, or `column 7: what is wrong`.
std::string read(std::string_view text) {
  RingTone tone;
  if (const auto error = read_rtttl(text, tone)) {
    return "column " + std::to_string(error->column) + ": " + std::string{message(error->what)};
  }
  std::string all;
  for (const Note& note : tone.notes) {
    if (!all.empty()) all += ' ';
    all += std::string{note_name(note.number).view()} + ':' + std::to_string(note.duration.value);
  }
  return all;
}

// At 120 beats a minute a quarter is half a second.
std::string read_at_120(const std::string& notes) { return read("t:d=4,o=5,b=120:" + notes); }

TEST(Rtttl, ReadsDurationLetterSharpDotAndOctave) {
  EXPECT_EQ(read_at_120("c"), "c5:32");
  EXPECT_EQ(read_at_120("8c"), "c5:16");
  EXPECT_EQ(read_at_120("c#"), "c#5:32");
  EXPECT_EQ(read_at_120("c6"), "c6:32");
  EXPECT_EQ(read_at_120("16c#.7"), "c#7:12");
  EXPECT_EQ(read_at_120("16c#7."), "c#7:12");
  EXPECT_EQ(read_at_120("p,8p,8p."), "rest:32 rest:16 rest:24");
  EXPECT_EQ(read_at_120("1c,2c,4c,8c,16c,32c,64c"), "c5:128 c5:64 c5:32 c5:16 c5:8 c5:4 c5:2");
}

TEST(Rtttl, ConcertPitchIsA4) {
  EXPECT_EQ(read_at_120("a4"), "a4:32");
  RingTone tone;
  ASSERT_FALSE(read_rtttl("t:d=4,o=4,b=120:a", tone));
  EXPECT_EQ(tone.notes[0].number, 69);
}

TEST(Rtttl, ReadsHAsB) { EXPECT_EQ(read_at_120("h,b,h#4"), "b5:32 b5:32 c5:32"); }

TEST(Rtttl, RestHasNoUseForItsOctave) { EXPECT_EQ(read_at_120("8p6,p.9"), "rest:16 rest:48"); }

TEST(Rtttl, HasTheDefaultsOfPhones) {
  // A quarter at 63 beats a minute is 60.95 of 1/64 s.
  EXPECT_EQ(read("t::c"), "c6:61");
  EXPECT_EQ(read("t:b=120:c"), "c6:32");
  EXPECT_EQ(read("t:d=8,b=120:c"), "c6:16");
  EXPECT_EQ(read("t:o=4,b=120:c"), "c4:32");
}

// The forms of public collections, each as in docs/protocol.md.
TEST(Rtttl, ReadsASharpAsUnderscoreAndOnEitherSideOfTheLetter) {
  EXPECT_EQ(read_at_120("c_,8e_,c_6,c_.6"), "c#5:32 f5:16 c#6:32 c#6:48");
  EXPECT_EQ(read_at_120("8#d4,_d,#d.6"), "d#4:16 d#5:32 d#6:48");
  EXPECT_EQ(read_at_120("8d5#,8d5_."), "d#5:16 d#5:24");
  EXPECT_EQ(read_at_120("eb,8bb4,cb,hb"), "d#5:32 a#4:16 b4:32 a#5:32");
}

TEST(Rtttl, ReadsADotAfterTheDuration) {
  EXPECT_EQ(read_at_120("8.c6,4.p,8.#d4,.c"), "c6:24 rest:48 d#4:24 c5:48");
}

TEST(Rtttl, ReadsRAsARest) { EXPECT_EQ(read_at_120("8r,R."), "rest:16 rest:48"); }

TEST(Rtttl, ReadsUnitsAndNamesInFull) {
  EXPECT_EQ(read("t:d=4,o=5,b=120bpm:c"), "c5:32");
  EXPECT_EQ(read("t:d=4,b=120 BPM,o=5:c"), "c5:32");
  EXPECT_EQ(read("t:duration=8,octave=5,tempo=120:c"), "c5:16");
  EXPECT_EQ(read("t:d=8,o=5,bpm=120:c"), "c5:16");
}

TEST(Rtttl, ReadsControlsAmongTheNotes) {
  EXPECT_EQ(read_at_120("c,d=8,c,o=6,c,o5,c"), "c5:32 c5:16 c6:16 c5:16");
  EXPECT_EQ(read_at_120("c,b=240,c,b=60,c"), "c5:32 c5:16 c5:64");
  EXPECT_EQ(read_at_120("c,SS,c,sn,s=c,c,v=3,c,l=2,c"), "c5:32 c5:32 c5:32 c5:32 c5:32");
  EXPECT_EQ(read("t:d=4,o=5,b=120,c,8e"), "c5:32 e5:16");
}

// 16.67, 10.8 and 24 of 1/64 s, again and again: rounded to whole ones at each change of tempo they
// would drift.
TEST(Rtttl, ChangesOfTempoDoNotDrift) {
  std::string notes = "p";
  for (int i = 0; i < 40; ++i) notes += ",b=229,c,b=353,c,b=160,c";
  RingTone tone;
  ASSERT_FALSE(read_rtttl("t:d=4,o=5,b=120:" + notes, tone));
  const double exact = 32 + 40 * 60.0 * 64 * (1.0 / 229 + 1.0 / 353 + 1.0 / 160);
  EXPECT_EQ(duration(tone.notes).value, std::lround(exact));
}

TEST(Rtttl, PassesOverUnknownControls) {
  EXPECT_EQ(read("t:d=4,v=80,o=5,x=a.b#c,b=120,i=:c"), "c5:32");
}

TEST(Rtttl, ReadsControlsWithoutCommaOrEqualSign) {
  EXPECT_EQ(read("t:d=8 o=5 b=120:c"), "c5:16");
  EXPECT_EQ(read("t:d8,o5,b120,ss:c"), "c5:16");
  EXPECT_EQ(read(":b120:c"), "c6:32");
  EXPECT_EQ(read("B52: live:d8,o5,b120:c"), "c5:16");
}

TEST(Rtttl, NameAndControlsCanBeLeftOut) {
  EXPECT_EQ(read("d=8,o=5,b=120:c,e"), "c5:16 e5:16");
  EXPECT_EQ(read(":d=8,o=5,b=120:c"), "c5:16");
  EXPECT_EQ(read("tune:c"), "c6:61");
  EXPECT_EQ(read(":c"), "c6:61");
  EXPECT_EQ(read("d=4,b=120:d=8,c"), "c6:16");
  EXPECT_EQ(read("ss,d=8,b=120:c"), "c6:16");
  RingTone tone;
  ASSERT_FALSE(read_rtttl("d=4:c", tone));
  EXPECT_EQ(tone.name, "");
}

TEST(Rtttl, NameMayHaveColonsAndEqualSigns) {
  const std::vector<std::string> names{"Mission: Impossible", "a:b:c", "e=mc2", "12:30"};
  for (const std::string& name : names) {
    RingTone tone;
    const std::string text = name + ":d=8,o=5,b=120:c";
    ASSERT_FALSE(read_rtttl(text, tone)) << name;
    EXPECT_EQ(tone.name, name);
    EXPECT_EQ(tone.notes[0].duration.value, 16);
  }
}

TEST(Rtttl, TakesDefaultsInAnyOrderAndTheLastOfTwo) {
  EXPECT_EQ(read("t:b=120,o=4,d=8:c"), "c4:16");
  EXPECT_EQ(read("t:b=120,o=4,o=7:c"), "c7:32");
}

TEST(Rtttl, PassesOverStyleAndRepetitions) {
  EXPECT_EQ(read("t:d=4,o=5,b=120,s=N,l=15:c"), "c5:32");
  EXPECT_EQ(read("t:s=c,d=4,o=5,b=120:c"), "c5:32");
}

TEST(Rtttl, WhiteSpaceAndCaseDoNotMatter) {
  EXPECT_EQ(read(" t : D = 4 , o=5,\tB=120 :\r\n 8 C # . 6 ,\n  P , g\n"), "c#6:24 rest:32 g5:32");
  EXPECT_EQ(read("t:d=4,o=5,b=120,:c"), "c5:32");
}

TEST(Rtttl, CommaBehindTheLastNoteDoesNoHarm) { EXPECT_EQ(read_at_120("c,d, "), "c5:32 d5:32"); }

TEST(Rtttl, NameIsPartOfTheText) {
  const std::string_view text = "  Old Song :d=4:c";
  RingTone tone;
  ASSERT_FALSE(read_rtttl(text, tone));
  EXPECT_EQ(tone.name, "Old Song");
  EXPECT_EQ(tone.name.data(), text.data() + 2);
  ASSERT_FALSE(read_rtttl(":d=4:c", tone));
  EXPECT_EQ(tone.name, "");
}

TEST(Rtttl, HoldsANoteTooLongForOne) {
  // A whole note at 25 beats a minute: 614.4 of 1/64 s.
  EXPECT_EQ(read("t:d=1,o=5,b=25:c,d"), "c5:255 c5:255 c5:104 d5:255 d5:255 d5:105");
  EXPECT_EQ(read("t:d=1,o=5,b=60:c"), "c5:255 c5:1");
}

// 85 beats a minute, sixteenths: 11.29 of 1/64 s each. Rounded one by one, they would lose a second
// in 225 notes.
TEST(Rtttl, DurationsDoNotDrift) {
  std::string notes = "c";
  for (int i = 1; i < 225; ++i) notes += ",c";
  RingTone tone;
  ASSERT_FALSE(read_rtttl("t:d=16,o=5,b=85:" + notes, tone));
  ASSERT_EQ(tone.notes.size(), 225U);
  const double exact = 240.0 * 64 / 85 / 16;
  std::int32_t end = 0;
  for (std::size_t i = 0; i < tone.notes.size(); ++i) {
    end += tone.notes[i].duration.value;
    EXPECT_LE(std::abs(end - exact * static_cast<double>(i + 1)), 0.5001) << i;
  }
}

TEST(Rtttl, LeavesOutNotesWithoutDurationAndKeepsTheTime) {
  // 0.267 of 1/64 s each: the ends round to 0, 1, 1, 1, 1, 2, 2, 2.
  EXPECT_EQ(read("t:d=64,o=5,b=900:c,d,e,f,g,a,b,c6"), "d5:1 a5:1");
  EXPECT_EQ(read("t:d=64,o=5,b=900:c"), "column 19: there are no notes");
}

TEST(Rtttl, TakesTheLowestAndTheHighestNote) { EXPECT_EQ(read_at_120("g1,g9"), "g1:32 g9:32"); }

struct Wrong {
  std::string text;
  std::string error;
};

TEST(Rtttl, SaysWhereAndWhatIsWrong) {
  const std::string no_colon = "a ring tone is name:defaults:notes, with colons between";
  const std::string defaults = "defaults are d=, o= and b=, separated by commas";
  const std::string value =
      "d is 1, 2, 4, 8, 16, 32 or 64, o is 1 to 9, b is a whole number from 1 to 900, s is n, c or "
      "s";
  const std::string division = "a duration is 1, 2, 4, 8, 16, 32 or 64";
  const std::string letter = "a note is a to h, or p for a rest";
  const std::string dot = "a note has one dot";
  const std::string range = "out of range: the robot plays g1 to g9";
  const std::string comma = "notes are separated by commas";
  const std::string none = "there are no notes";
  const std::vector<Wrong> all{
      {"", "column 1: " + no_colon},
      {"name", "column 5: " + no_colon},
      {"c,d,e", "column 6: " + no_colon},
      {"name:d=4,o=5,b=63", "column 18: " + none},
      {"t:x4:c", "column 3: " + defaults},
      {"t:d=4;o=5:c", "column 6: " + defaults},
      {"t:d=4, =5:c", "column 8: " + defaults},
      {"t:c,d,e:", "column 3: " + defaults},
      {"t:d=:c", "column 5: " + value},
      {"t:d=3:c", "column 5: " + value},
      {"t:d=0:c", "column 5: " + value},
      {"t:d=128:c", "column 5: " + value},
      {"t:o=0:c", "column 5: " + value},
      {"t:o=10:c", "column 5: " + value},
      {"t:o=5, b=0:c", "column 10: " + value},
      {"t:b=901:c", "column 5: " + value},
      {"t:b=99999999999999999999:c", "column 5: " + value},
      {"t:b=-5:c", "column 5: " + value},
      {"t:b=112.5:c", "column 8: " + value},
      {"t:s=x:c", "column 5: " + value},
      {"t::3c", "column 4: " + division},
      {"t::c, 0c", "column 7: " + division},
      {"t::18446744073709551620c", "column 4: " + division},
      {"t::x", "column 4: " + letter},
      {"t::c,,d", "column 6: " + letter},
      {"t::,c", "column 4: " + letter},
      {"t::8", "column 5: " + letter},
      {"t::c, 4#", "column 9: " + letter},
      {"t::c..", "column 6: " + dot},
      {"t::c.5.", "column 7: " + dot},
      {"t::c5..", "column 7: " + dot},
      {"t::8p..", "column 7: " + dot},
      {"t::c5, f#1", "column 10: " + range},
      {"t::c0", "column 5: " + range},
      {"t::c10", "column 5: " + range},
      {"t::g#9", "column 6: " + range},
      {"t:o=1:c", "column 7: " + range},
      {"t::c d", "column 6: " + comma},
      {"t::c5##", "column 7: " + comma},
      {"t::#c#", "column 6: " + comma},
      {"t::#", "column 5: " + letter},
      {"t::#p", "column 5: " + letter},
      {"t::8.c6.", "column 8: " + dot},
      {"t::8..c", "column 6: " + dot},
      {"t::c,d=3,e", "column 8: " + value},
      {"t::c,s=x", "column 8: " + value},
      {"t::c,b=0", "column 8: " + value},
      {"t::c,o0", "column 7: " + value},
      {"t::c,xyz", "column 6: " + letter},
      {"t::c;d", "column 5: " + comma},
      {"t::p#", "column 5: " + comma},
      {"t::c:d", "column 5: " + comma},
      {"t::", "column 4: " + none},
      {"t:d=4:  \n", "column 10: " + none},
  };
  std::set<std::string> seen;
  for (const Wrong& wrong : all) {
    EXPECT_EQ(read(wrong.text), wrong.error) << wrong.text;
    seen.insert(wrong.error.substr(wrong.error.find(": ") + 2));
  }
  EXPECT_EQ(seen.size(), 9U);  // all but the one for too many notes
}

TEST(Rtttl, TakesNulForNothingSpecial) {
  EXPECT_EQ(read(std::string_view{"t::c\0", 5}), "column 5: notes are separated by commas");
  EXPECT_EQ(read(std::string_view{"t::c,\0", 6}), "column 6: a note is a to h, or p for a rest");
}

TEST(Rtttl, RefusesMoreNotesThanAllSlotsHold) {
  std::string text = "t:b=120:c";
  for (int i = 1; i < 256; ++i) text += ",c";
  RingTone tone;
  EXPECT_FALSE(read_rtttl(text, tone));
  EXPECT_EQ(tone.notes.size(), 256U);
  EXPECT_EQ(read(text + ", c"), "column 522: too long: sixteen songs of sixteen notes hold 256");
}

TEST(Rtttl, LeavesTheToneAloneWhereTheTextIsWrong) {
  RingTone tone;
  ASSERT_FALSE(read_rtttl("good:b=120:c", tone));
  EXPECT_TRUE(read_rtttl("bad:b=120:d,e,x", tone));
  EXPECT_EQ(tone.name, "good");
  ASSERT_EQ(tone.notes.size(), 1U);
  EXPECT_EQ(tone.notes[0].number, 84);
}

// Melodies long out of copyright, set for this test.
constexpr std::string_view kOdeToJoy =
    "Ode to Joy:d=4,o=5,b=120:e,e,f,g,g,f,e,d,c,c,d,e,e.,8d,2d,"
    "e,e,f,g,g,f,e,d,c,c,d,e,d.,8c,2c";
constexpr std::string_view kFrereJacques =
    "Frere Jacques:d=4,o=5,b=100:c,d,e,c,c,d,e,c,e,f,2g,e,f,2g,"
    "8g,8a,8g,8f,e,c,8g,8a,8g,8f,e,c,c,g4,2c,c,g4,2c";
constexpr std::string_view kFuerElise =
    "Fuer Elise:d=8,o=5,b=125:32p,e6,d#6,e6,d#6,e6,b,d6,c6,4a.,32p,c,e,a,4b.,32p,e,g#,b,4c.6,32p,"
    "e,e6,d#6,e6,d#6,e6,b,d6,c6,4a.,32p,c,e,a,4b.,32p,d,c6,b,2a";

TEST(Rtttl, ReadsOdeToJoy) {
  RingTone tone;
  ASSERT_FALSE(read_rtttl(kOdeToJoy, tone));
  EXPECT_EQ(tone.name, "Ode to Joy");
  ASSERT_EQ(tone.notes.size(), 30U);
  // Eight bars of four quarters of half a second.
  EXPECT_EQ(duration(tone.notes), SixtyFourths{8 * 4 * 32});
  EXPECT_EQ(tone.notes[12], (Note{76, SixtyFourths{48}}));
  EXPECT_EQ(tone.notes[13], (Note{74, SixtyFourths{16}}));
  EXPECT_EQ(tone.notes[29], (Note{72, SixtyFourths{64}}));
  EXPECT_EQ(split(tone.notes)->size(), 2U);
}

TEST(Rtttl, ReadsFrereJacques) {
  RingTone tone;
  ASSERT_FALSE(read_rtttl(kFrereJacques, tone));
  ASSERT_EQ(tone.notes.size(), 32U);
  // 8 bars of 4 quarters at 100 a minute: 19.2 s, 1228.8 of 1/64 s.
  EXPECT_EQ(duration(tone.notes), SixtyFourths{1229});
  EXPECT_EQ(tone.notes[27].number, 67);
}

TEST(Rtttl, ReadsFuerElise) {
  RingTone tone;
  ASSERT_FALSE(read_rtttl(kFuerElise, tone));
  ASSERT_EQ(tone.notes.size(), 41U);
  EXPECT_EQ(tone.notes[0], (Note{kRest, SixtyFourths{4}}));
  EXPECT_EQ(tone.notes[1].number, 88);
  EXPECT_EQ(tone.notes[2].number, 87);
  EXPECT_EQ(tone.notes[19].number, 84);
  EXPECT_EQ(split(tone.notes)->size(), 3U);
}

// What holds for every text: either the tone is untouched and the column is in the text or right
// after it, or every note can be sent.
void check(const std::string& text) {
  RingTone tone;
  // With no byte after it, so that a sanitizer sees a read past the end.
  const std::vector<char> exact(text.begin(), text.end());
  const auto error = read_rtttl({exact.data(), exact.size()}, tone);
  if (error) {
    EXPECT_TRUE(tone.notes.empty());
    EXPECT_GE(error->column, 1U);
    EXPECT_LE(error->column, text.size() + 1);
    EXPECT_FALSE(message(error->what).empty());
    return;
  }
  EXPECT_FALSE(tone.notes.empty());
  EXPECT_TRUE(split(tone.notes));
  for (const Note& note : tone.notes) {
    EXPECT_TRUE(note.number == kRest || !is_rest(note.number));
    EXPECT_GE(note.duration.value, 1);
    EXPECT_LE(note.duration.value, kMaxNoteDuration);
  }
}

TEST(Rtttl, TruncatedTextsAreHarmless) {
  for (const std::string_view tune : {kOdeToJoy, kFrereJacques, kFuerElise}) {
    for (std::size_t size = 0; size <= tune.size(); ++size) {
      check(std::string{tune.substr(0, size)});
    }
  }
}

TEST(Rtttl, GarbledTextsAreHarmless) {
  std::mt19937 random{20060101};
  std::uniform_int_distribution<int> any{0, 255};
  constexpr std::string_view kLikely = "abcdefghp#.,:=0123456789 \nobdsl";
  for (int round = 0; round < 5000; ++round) {
    std::string text{round % 2 == 0 ? kOdeToJoy : kFuerElise};
    const int count = 1 + round % 4;
    for (int i = 0; i < count; ++i) {
      const std::size_t at = std::uniform_int_distribution<std::size_t>{0, text.size() - 1}(random);
      text[at] = round % 3 == 0 ? static_cast<char>(any(random))
                                : kLikely[static_cast<std::size_t>(any(random)) % kLikely.size()];
    }
    check(text);
  }
}

}  // namespace
}  // namespace cargobay::oi
