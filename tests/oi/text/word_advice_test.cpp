#include "oi/text/word_advice.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oi/text/argument_names.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/nearest_name.hpp"

namespace cargobay::oi {
namespace {

using testing::HasSubstr;

// What format_error() says; empty for a text without an error.
std::string complaint_about(std::string_view text, Beyond beyond = Beyond::nothing) {
  std::array<std::uint8_t, 256> bytes{};
  const TextResult result = encode_text(text, bytes, beyond);
  if (!result.error) return "";
  std::array<char, 400> message{};
  const std::size_t size = format_error(*result.error, text, message);
  EXPECT_LT(size, message.size()) << text;
  return {message.data(), size};
}
// The name that a complaint guesses; empty if it guesses none.
std::string guess_in(const std::string& complaint) {
  constexpr std::string_view kBefore = "did you mean '";
  const std::size_t begin = complaint.find(kBefore);
  if (begin == std::string::npos) return "";
  const std::size_t name = begin + kBefore.size();
  return complaint.substr(name, complaint.find('\'', name) - name);
}
std::string guess_for(std::string_view text) { return guess_in(complaint_about(text)); }
bool moves(std::string_view name) {
  return std::ranges::any_of(kCommands, [name](const CommandInfo& info) {
    return info.key == name && may_turn_wheels(info);
  });
}

TEST(WordAdvice, SaysWhatAWordOfOtherRobotsIsHere) {
  struct Row {
    const char* word;
    const char* says;
  };
  for (const Row& row :
       std::initializer_list<Row>{{"halt", "to stop the wheels, write: stop"},
                                  {"HALT", "to stop the wheels, write: stop"},
                                  {"e-stop", "to stop the wheels, write: stop"},
                                  {"full_stop", "to stop the wheels, write: stop"},
                                  {"motors_stop_now", "to stop the wheels, write: stop"},
                                  {"safe_mode", "start, safe and full set it"},
                                  {"start_stream", "stream PACKET"},
                                  {"fwd", "drive_direct LEFT RIGHT"},
                                  {"bumpers", "sensors PACKET"},
                                  {"ping", "sensors oi_mode"},
                                  {"passive", "start"},
                                  {"off", "press its power button"},
                                  {"power", "press its power button"},
                                  {"wake", "press its power button"},
                                  {"reset", "the manual has no reset"},
                                  {"reset", "Some robots know soft_reset"},
                                  {"version", "Some robots know firmware_date"},
                                  {"halt!", "to stop the wheels, write: stop"},
                                  {"off()", "press its power button"},
                                  {"power off", "no command switches the Create off"},
                                  {"power on", "no byte wakes a Create that is off"},
                                  {"turn off", "no command switches the Create off"},
                                  {"turn left", "drive_direct LEFT RIGHT"},
                                  {"go home", "docking is a demo here"},
                                  {"e stop", "to stop the wheels, write: stop"},
                                  {"hex 89 00", "bytes BYTE ..."},
                                  {"128 131", "bytes BYTE ..."},
                                  {"0x83", "bytes BYTE ..."},
                                  {"ringtone", "tune SLOT RTTTL"},
                                  {"dock", "drives the robot: cover_and_dock"},
                                  {"SeekDock", "drives the robot: cover_and_dock"},
                                  {"clean", "a demo here, which drives the robot over the floor"},
                                  {"motors", "low_side_drivers"},
                                  {"motors off", "to stop the wheels, write: stop"},
                                  {"spin", "drive_direct LEFT RIGHT"},
                                  {"forward", "drive_direct LEFT RIGHT"},
                                  {"beep", "song SLOT"},
                                  {"battery", "sensors battery_charge"},
                                  {"mode", "sensors oi_mode"},
                                  {"distance", "sensors PACKET"},
                                  {"banjo", "demo NAME"},
                                  {"digit-leds", "Create 2"},
                                  {"wait", "wait_time"},
                                  {"connect", "start"}}) {
    EXPECT_THAT(complaint_about(row.word), HasSubstr(row.says)) << row.word;
    EXPECT_EQ(guess_for(row.word), "") << row.word;
  }
  EXPECT_EQ(complaint_about("start; halt"),
            "column 8: 'halt' is not a command; to stop the wheels, write: stop; to end a demo: "
            "demo abort; to end both, into Passive mode: start");
}

TEST(WordAdvice, SaysWhatAValueOfEveryDayIsHere) {
  EXPECT_THAT(complaint_about("sensors all"), HasSubstr("packet 6 has all"));
  EXPECT_THAT(complaint_about("demo stop"), HasSubstr("to end a demo, write: demo abort"));
  EXPECT_THAT(complaint_about("drive stop 0"), HasSubstr("to stop the wheels, write: stop"));
  EXPECT_THAT(complaint_about("drive_direct 0 off"), HasSubstr("write: stop"));
  EXPECT_THAT(complaint_about("drive 100 left"), HasSubstr("a positive radius curves to the left"));
  EXPECT_THAT(complaint_about("drive 100 right"), HasSubstr("a negative one to the right"));
}

// What the advice tells to write can be written.
TEST(WordAdvice, NamesOnlyCommandsThatThereAre) {
  for (const char* const text :
       {"stop", "demo abort", "start", "sensors battery_charge", "sensors oi_mode",
        "leds play 0 255", "pause_resume_stream pause", "pause_resume_stream resume",
        "digital_outputs output_0", "sensors 6", "stream distance", "baud 57600", "cover_and_dock",
        "drive_direct 1 1", "soft_reset", "firmware_date", "bytes 142 7",
        "tune 0 name:d=4,o=5,b=120:8c"}) {
    EXPECT_EQ(complaint_about(text, Beyond::manual), "") << text;
  }
}

TEST(WordAdvice, KnowsMisspeltWordsBeyondTheManualWhereTheyAreAllowed) {
  EXPECT_EQ(guess_in(complaint_about("byte 7", Beyond::manual)), "bytes");
  EXPECT_EQ(guess_in(complaint_about("frimware_date", Beyond::manual)), "firmware_date");
  EXPECT_EQ(guess_for("frimware_date"), "");
}

TEST(StopWord, StopsTheWheels) {
  std::array<std::uint8_t, 16> bytes{};
  const TextResult result = encode_text("stop", bytes);
  ASSERT_FALSE(result.error);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 5),
            (std::vector<std::uint8_t>{145, 0, 0, 0, 0}));
  EXPECT_EQ(result.bytes, 5U);
  EXPECT_EQ(encode_text("script { drive 300 straight; wait_time 10; stop }", bytes).bytes,
            2U + 12U);
  EXPECT_THAT(complaint_about("stop now"), HasSubstr("stop takes no arguments"));
  EXPECT_THAT(complaint_about("stop { }"), HasSubstr("a brace is not allowed here"));
}

TEST(StopWord, FitsTheRoomThatIsStated) {
  std::string text = "stop";
  for (int i = 0; i < 20; ++i) text += ";stop";
  std::vector<std::uint8_t> bytes(most_bytes(text));
  EXPECT_EQ(encode_text(text, bytes).bytes, bytes.size());
}

// Words with one meaning elsewhere and none here, and words that people say to robots.
constexpr const char* kOtherWords[]{
    "stop",        "spin",     "power",        "wake",      "halt",     "off",
    "dock",        "clean",    "reset",        "passive",   "motors",   "rover",
    "hover",       "slot",     "spit",         "spat",      "shot",     "soot",
    "sport",       "snot",     "step",         "shop",      "spout",    "port",
    "pot",         "over",     "lover",        "mover",     "memo",     "mode",
    "done",        "demand",   "deny",         "drone",     "live",     "dry",
    "dividers",    "control2", "recover",      "discover",  "play",     "play_song",
    "script_play", "direct",   "drive_wheels", "drive_pwm", "driver_0", "drive_backwards",
    "drive_off",   "park",     "sit",          "stay",      "freeze",   "quiet",
    "hold",        "end",      "kill",         "e_stop",    "stop!",    "stop()",
    "sop",         "stpo",     "stopp",        "tops",      "post",     "max",
    "safe",        "idle"};

TEST(Suggestions, NeverSetARobotInMotion) {
  for (const std::string_view word : kOtherWords) {
    const std::string guess = guess_for(word);
    EXPECT_FALSE(moves(guess)) << word << " -> " << guess;
  }
  // Arguments of commands that move.
  for (const char* const text :
       {"demo home_base", "demo hover", "demo mops", "demo tango", "drive 100 right",
        "drive 100 anticlockwise", "drive 100 forwards", "drive 100 stop"}) {
    EXPECT_EQ(guess_for(text), "") << text;
  }
}

TEST(Suggestions, DoNotTakeTheGuardOfSafeModeAway) {
  for (const char* const word : {"pull", "null", "fell", "fall", "fuel", "bull"})
    EXPECT_NE(guess_for(word), "full") << word;
  for (const char* const word : {"ful", "fulll", "flul", "Full"})
    EXPECT_EQ(guess_for(word), "full") << word;
}

TEST(Suggestions, NameAMotionForItsMisspelling) {
  struct Row {
    const char* word;
    const char* meant;
  };
  for (const Row& row : std::initializer_list<Row>{{"spto", "spot"},
                                                   {"spott", "spot"},
                                                   {"spo", "spot"},
                                                   {"SPOT", "spot"},
                                                   {"demoo", "demo"},
                                                   {"dmeo", "demo"},
                                                   {"covr", "cover"},
                                                   {"coverr", "cover"},
                                                   {"drvie", "drive"},
                                                   {"dirve", "drive"},
                                                   {"driv", "drive"},
                                                   {"drivedirect", "drive_direct"},
                                                   {"DriveDirect", "drive_direct"},
                                                   {"drive_drect", "drive_direct"},
                                                   {"drive_dirct", "drive_direct"},
                                                   {"coveranddock", "cover_and_dock"},
                                                   {"cover_and_doc", "cover_and_dock"},
                                                   {"playscript", "play_script"},
                                                   {"sotp", "stop"},
                                                   {"stopp", "stop"}}) {
    EXPECT_EQ(guess_for(row.word), row.meant) << row.word;
  }
  EXPECT_EQ(guess_for("demo banjoo"), "banjo");
  EXPECT_EQ(guess_for("demo figure_eight"), "");
  EXPECT_EQ(guess_for("drive 100 strait"), "straight");
  EXPECT_EQ(guess_for("drive 100 counterclockwise"), "counter_clockwise");
}

// Every word at one letter from a command that moves: changed, added, lost, swapped. A guess keeps
// the first letter, and of a short name its letters.
TEST(Suggestions, KeepTheLettersOfAShortName) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz";
  for (const std::string_view name : {"spot", "demo"}) {
    for (std::size_t at = 0; at < name.size(); ++at) {
      for (const char letter : kLetters) {
        if (letter == name[at]) continue;
        std::string changed{name};
        changed[at] = letter;
        EXPECT_FALSE(moves(guess_for(changed))) << changed;
      }
    }
  }
}

TEST(NearestNameOfMotion, NeedsTheFirstLetter) {
  for (const std::string_view word : {"over", "rover", "hover", "mover", "xcover"}) {
    NearestName nearest{word};
    nearest.consider_misspelt("cover");
    EXPECT_EQ(nearest.name(), "") << word;
  }
}

TEST(IsSpeltAlike, SeesThroughCaseAndSeparators) {
  EXPECT_TRUE(is_spelt_alike("Seek-Dock", "seek_dock"));
  EXPECT_TRUE(is_spelt_alike("seekdock", "seek_dock"));
  EXPECT_FALSE(is_spelt_alike("seekdoc", "seek_dock"));
  EXPECT_FALSE(is_spelt_alike(std::string(50, 'a'), std::string(60, 'b')));
  EXPECT_FALSE(is_spelt_alike(std::string(50, 'a'), ""));
}

}  // namespace
}  // namespace cargobay::oi
