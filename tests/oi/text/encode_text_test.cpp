#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oi/commands.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/command_text.hpp"
#include "tests/oi/text/encoded.hpp"

namespace cargobay::oi {
namespace {

using testing::HasSubstr;

TEST(EncodeText, SeparatesCommandsBySemicolonsAndLines) {
  const Bytes both{131, 145, 0, 100, 0, 100};
  EXPECT_EQ(bytes_of("safe; drive_direct 100 100"), both);
  EXPECT_EQ(bytes_of(";;safe\n\n  drive_direct\t100 100 ;\r\n"), both);
}

TEST(EncodeText, PassesOverComments) {
  EXPECT_EQ(bytes_of("# first\nsafe # then\n#\nfull"), (Bytes{131, 132}));
  EXPECT_EQ(bytes_of("script { safe # half of it } ; full\n full }"), (Bytes{152, 2, 131, 132}));
  EXPECT_THAT(error_of("send_ir 1#2"), HasSubstr("byte '1#2' is not a number"))
      << "a comment begins at the beginning of a word";
}

TEST(EncodeText, MakesNothingOfNoCommands) {
  for (const std::string_view text : {"", " ", "\n", ";;", "# nothing", " ; # \n ;"})
    EXPECT_EQ(bytes_of(text), Bytes{}) << text;
}

TEST(EncodeText, TakesAScriptOfExactlyAHundredBytes) {
  std::string text = "script { ";
  for (int i = 0; i < 20; ++i) text += "drive 1 2; ";
  EXPECT_EQ(bytes_of(text + "}").size(), 102U);
  EXPECT_EQ(error_of(text + "safe }"),
            "column 230: script: from here on it is longer than 100 bytes");
}

TEST(EncodeText, TakesRawBytesInAScript) {
  EXPECT_EQ(bytes_of("script { bytes 137 0x1 }"), (Bytes{152, 2, 137, 1}));
  EXPECT_EQ(error_of("bytes 1"), "column 1: 'bytes' is allowed in a script only");
  EXPECT_EQ(error_of("script { bytes }"), "column 16: bytes: byte is missing; it is 0 to 255");
  EXPECT_EQ(error_of("script { bytes 256 }"),
            "column 16: bytes: byte '256' is out of range; it is 0 to 255");
}

TEST(EncodeText, GoesBeyondTheManualOnlyIfAllowed) {
  const auto allowed = [](std::string_view text) {
    return encode_with_room(text, 100, Beyond::manual);
  };
  EXPECT_EQ(allowed("safe; bytes 173 0x07; soft_reset; firmware_date").bytes,
            (Bytes{131, 173, 7, 7, 8}));
  EXPECT_EQ(allowed("bytes").error, "column 6: bytes: byte is missing; it is 0 to 255");
  EXPECT_EQ(
      allowed("soft_reset 3").error,
      "column 12: soft_reset: '3' is too much: it takes no arguments; separate commands with ;");
  EXPECT_THAT(error_of("safe; soft_reset"),
              HasSubstr("column 7: 'soft_reset' is not in the manual"));
  EXPECT_THAT(allowed("script { firmware_date }").error, HasSubstr("is not in the manual"));
}

// Tunes.

TEST(EncodeText, StoresATune) {
  EXPECT_EQ(bytes_of("tune 0 name:d=4,o=5,b=120:8c,8e_,g."),
            (Bytes{140, 0, 3, 72, 16, 77, 16, 79, 48}));
  EXPECT_EQ(bytes_of("safe; tune 3 Ode to Joy:d=4,o=5,b=120:e, 8 f # 5 , ; full"),
            bytes_of("safe; song 3 e5:32 f#5:16; full"));
}

TEST(EncodeText, SplitsATuneOverTheSlots) {
  std::string text = "tune 14 x:d=4,o=5,b=120:c";
  for (int i = 1; i < 17; ++i) text += ",c";
  const Bytes bytes = bytes_of(text);
  ASSERT_EQ(bytes.size(), 3U + 32 + 3 + 2);
  EXPECT_EQ((Bytes{bytes.end() - 5, bytes.end()}), (Bytes{140, 15, 1, 72, 32}));
  for (int i = 17; i < 33; ++i) text += ",c";
  EXPECT_EQ(error_of(text), "column 9: tune: too long: the slots from this one on hold 32 notes");
}

TEST(EncodeText, FindsTheEndOfATune) {
  const Bytes one = bytes_of("song 0 84:32");
  EXPECT_EQ(bytes_of("tune 0 x:b=120:c   # a comment, not a note"), one);
  EXPECT_EQ(bytes_of("tune 0 x:b=120: #c, #d  # comment"), bytes_of("song 0 c#6:32 d#6:32"));
  EXPECT_EQ(bytes_of("tune 0 x:b=120:c\nfull"), bytes_of("song 0 84:32; full"));
  EXPECT_EQ(bytes_of("script { tune 0 x:b=120:c }"), bytes_of("script { song 0 84:32 }"));
  EXPECT_THAT(error_of("tune 0 # x:c\n"), HasSubstr("the ring tone is missing"));
}

TEST(EncodeText, SaysWhereATuneIsWrong) {
  EXPECT_EQ(error_of("tune"), "column 5: tune: slot is missing; it is 0 to 15");
  EXPECT_EQ(error_of("tune 16 x:c"), "column 6: tune: slot '16' is out of range; it is 0 to 15");
  EXPECT_EQ(error_of("tune x:d=4:c"),
            "column 6: tune: slot 'x:d=4:c' is not a number; it is 0 to 15");
  EXPECT_EQ(error_of("tune 0"),
            "column 7: tune: the ring tone is missing; write: tune 0 name:d=4,o=5,b=120:8c,8e_,g.");
  EXPECT_EQ(error_of("safe\ntune 0 x:d=4:c, 8x"),
            "line 2, column 18: tune: a note is a to h, or p for a rest");
  EXPECT_EQ(error_of("tune 0 x:d=4:c,8"), "column 17: tune: a note is a to h, or p for a rest");
  EXPECT_EQ(error_of("tnue 0 x:c"), "column 1: 'tnue' is not a command; did you mean 'tune'?");
}

TEST(EncodeText, NoTextMakesMoreBytesThanSaid) {
  std::string text = "tune 0 x:d=1,o=5,b=1:";
  for (int i = 0; i < 4; ++i) text += "1c,";
  const std::size_t most = most_bytes(text);
  EXPECT_EQ(encode_with_room(text, most).bytes.size(), 16U * 3 + 2 * 244);
  EXPECT_EQ(most_bytes("safe"), 5U);
}

TEST(EncodeText, FillsTheBufferAndNoMore) {
  EXPECT_EQ(encode_with_room("drive -200 500", 5).bytes.size(), 5U);
  for (std::size_t room = 0; room < 5; ++room) {
    EXPECT_EQ(encode_with_room("drive -200 500", room).error,
              "column 1: the commands make more than " + std::to_string(room) + " bytes");
  }
  for (std::size_t room = 0; room < 8; ++room) {
    EXPECT_EQ(encode_with_room("script { song 1 2:3 }; safe", room).what->code,
              TextError::Code::output_full);
  }
}

// Errors, by their text.

TEST(EncodeText, NamesArgumentRangeAndUnit) {
  EXPECT_EQ(error_of("safe; drive 600 0"),
            "column 13: drive: velocity '600' is out of range; it is -500 to 500 mm/s");
  EXPECT_EQ(error_of("drive_direct 1 -501"),
            "column 16: drive_direct: right '-501' is out of range; it is -500 to 500 mm/s");
  EXPECT_EQ(error_of("drive_direct 501 1"),
            "column 14: drive_direct: left '501' is out of range; it is -500 to 500 mm/s");
  EXPECT_EQ(error_of("pwm_low_side_drivers 0 0 129"),
            "column 26: pwm_low_side_drivers: driver_2 '129' is out of range; it is 0 to 128");
  EXPECT_EQ(error_of("drive 1 2001"),
            "column 9: drive: radius '2001' is out of range; it is -2000 to 2000 mm, or straight, "
            "clockwise or counter_clockwise");
  EXPECT_EQ(error_of("drive 65336 0"),
            "column 7: drive: velocity '65336' is out of range; it is -500 to 500 mm/s")
      << "only hexadecimal is two's complement";
  EXPECT_EQ(
      error_of("wait_event 0"),
      "column 12: wait_event: event '0' is out of range; it is -22 to 22 but not 0, or a name "
      "such as front_left_cliff");
  EXPECT_EQ(error_of("leds 1 0 0"),
            "column 6: leds: leds '1' is out of range; it is none, or play (2), advance (8) "
            "separated by commas, or their sum");
  EXPECT_EQ(error_of("baud 9601"),
            "column 6: baud: code '9601' is out of range; it is 0 to 11, or 300, 600, 1200, 2400, "
            "4800, 9600, 14400, 19200, 28800, 38400, 57600 or 115200");
  EXPECT_EQ(error_of("sensors 43"),
            "column 9: sensors: packet '43' is out of range; it is 0 to 42, or a name such as "
            "charging_state");
  EXPECT_EQ(error_of("song 0 60:256"),
            "column 11: song: duration '256' is out of range; it is 0 to 255 s/64");
  EXPECT_EQ(error_of("send_ir 99999999999999999999"),
            "column 9: send_ir: byte '99999999999999999999' is out of range; it is 0 to 255");
  EXPECT_THAT(error_of("drive 0xffff38 0"), HasSubstr("out of range"));
  EXPECT_THAT(error_of("wait_event 128"), HasSubstr("out of range"));
  EXPECT_THAT(error_of("wait_time -1"), HasSubstr("out of range"));
}

TEST(EncodeText, NamesTheLineWhereThereAreSeveral) {
  EXPECT_EQ(error_of("safe\n  drive 600 0\n"),
            "line 2, column 9: drive: velocity '600' is out of range; it is -500 to 500 mm/s");
  EXPECT_EQ(error_of("script {\n  drive 1 2\n  drvie\n}"),
            "line 3, column 3: 'drvie' is not a command; did you mean 'drive'?");
  EXPECT_THAT(error_of("\n}"), HasSubstr("line 2, column 1: "));
  EXPECT_THAT(error_of("safe 1\n"), HasSubstr("line 1, column 6: "));
}

TEST(EncodeText, SuggestsACommand) {
  const auto unknown = [](std::string_view word) {
    return "column 1: '" + std::string{word} + "' is not a command";
  };
  for (const auto& [word, meant] : std::initializer_list<std::pair<std::string_view, std::string>>{
           {"drvie", "drive"},
           {"DRIVE", "drive"},
           {"drive-direct", "drive_direct"},
           {"drivedirect", "drive_direct"},
           {"led", "leds"},
           {"sensor", "sensors"},
           {"Safe", "safe"},
           {"wait_evnet", "wait_event"},
           {"show_scripts", "show_script"}}) {
    EXPECT_EQ(error_of(word), unknown(word) + "; did you mean '" + meant + "'?");
  }
  for (const std::string_view word : {"xyzzy", "a", "-x200", "fly_to_the_moon"})
    EXPECT_EQ(error_of(word), unknown(word));
  EXPECT_EQ(error_of(std::string(100, 'x')), unknown(std::string(40, 'x') + "..."));
  EXPECT_EQ(error_of("\x01\xff\x7f"), unknown("???"));
}

TEST(EncodeText, SuggestsAName) {
  EXPECT_EQ(error_of("sensors distanse"),
            "column 9: sensors: packet 'distanse' is neither a number nor a name it knows; did you "
            "mean 'distance'? It is 0 to 42, or a name such as charging_state");
  EXPECT_THAT(error_of("wait_event no-bump"), HasSubstr("did you mean 'no_bump'?"));
  EXPECT_THAT(error_of("drive 100 strait"), HasSubstr("did you mean 'straight'?"));
  EXPECT_THAT(error_of("leds advanced 0 0"), HasSubstr("did you mean 'advance'?"));
  EXPECT_THAT(error_of("pause_resume_stream resum"), HasSubstr("did you mean 'resume'?"));
}

TEST(EncodeText, RefusesWhatIsNoNumber) {
  EXPECT_EQ(error_of("drive fast 0"),
            "column 7: drive: velocity 'fast' is not a number; it is -500 to 500 mm/s");
  for (const std::string_view word : {"1x", "0x", "--1", "-", "1.5", "+", "1e2", "0x1g", "_"})
    EXPECT_THAT(error_of("send_ir " + std::string{word}), HasSubstr("is not a number")) << word;
  EXPECT_THAT(error_of("stream 29,,13"),
              HasSubstr("column 11: stream: packet '' is neither a number"));
  EXPECT_THAT(error_of("leds play, 0 0"), HasSubstr("leds 'play,' is neither"));
  EXPECT_THAT(error_of("leds play,2 0 0"), HasSubstr("leds 'play,2' is neither"));
}

TEST(EncodeText, RefusesTooFewAndTooManyArguments) {
  EXPECT_EQ(
      error_of("drive 100"),
      "column 10: drive: radius is missing; it is -2000 to 2000 mm, or straight, clockwise or "
      "counter_clockwise");
  EXPECT_EQ(error_of("drive; safe"),
            "column 6: drive: velocity is missing; it is -500 to 500 mm/s");
  EXPECT_EQ(error_of("stream"),
            "column 7: stream: packet is missing; it is 0 to 42, or a name such as charging_state, "
            "or none");
  EXPECT_THAT(error_of("song 1"), HasSubstr("song: note is missing"));
  EXPECT_EQ(error_of("safe full"),
            "column 6: safe: 'full' is too much: it takes no arguments; separate commands with ;");
  EXPECT_EQ(error_of("drive_direct 1 2 3"),
            "column 18: drive_direct: '3' is too much: it takes left and right; separate commands "
            "with ;");
  EXPECT_EQ(error_of("leds none 0 0 0"),
            "column 15: leds: '0' is too much: it takes leds, power_color and power_intensity; "
            "separate commands with ;");
  EXPECT_EQ(error_of("script { } safe"),
            "column 12: script: 'safe' follows the script; separate commands with ;");
  EXPECT_THAT(error_of("stream none 7"), HasSubstr("'7' is too much"));
}

TEST(EncodeText, CountsNotesAndPackets) {
  EXPECT_EQ(
      error_of("song 1 60"),
      "column 8: song: '60' is not a note; write note:duration, such as 60:32, c4:32 or rest:16");
  EXPECT_THAT(error_of("song 1 h4:8"), HasSubstr("'h4'"));
  EXPECT_THAT(error_of("song 1 f#1:8"), HasSubstr("'f#1'")) << "below what the robot sounds";
  const auto repeated = [](std::string text, std::string_view word, int times) {
    while (times-- > 0) text += word;
    return text;
  };
  EXPECT_EQ(bytes_of(repeated("song 1", " 60:1", 16)).size(), 3U + 32U);
  EXPECT_EQ(error_of(repeated("song 1", " 60:1", 17)), "column 88: song: more than 16 notes");
  EXPECT_EQ(bytes_of(repeated("stream", " 7", 43)).size(), 45U);
  EXPECT_EQ(error_of(repeated("stream", " 7", 44)), "column 94: stream: more than 43 packets");
  EXPECT_EQ(bytes_of(repeated("query_list", " 7", 255)).size(), 257U);
  EXPECT_EQ(error_of(repeated("query_list", " 7", 256)),
            "column 522: query_list: more than 255 packets");
}

TEST(EncodeText, KeepsBracesToScripts) {
  EXPECT_EQ(
      error_of("script 1 2"),
      "column 8: script: its commands go in braces: script { drive 300 straight; drive 0 0 }");
  EXPECT_EQ(error_of("script { safe"), "column 8: script: this brace is not closed");
  EXPECT_EQ(error_of("script { script { } }"), "column 10: script: a script cannot hold a script");
  constexpr std::string_view kStray = "a brace is not allowed here; only a script has braces";
  EXPECT_EQ(error_of("}"), "column 1: " + std::string{kStray});
  EXPECT_EQ(error_of("safe { }"), "column 6: safe: " + std::string{kStray});
  EXPECT_EQ(error_of("script { } }"), "column 12: " + std::string{kStray});
  EXPECT_EQ(error_of("{ safe }"), "column 1: " + std::string{kStray});
  EXPECT_EQ(error_of("script { { } }"), "column 10: " + std::string{kStray});
}

TEST(FormatError, StaysWithinItsBuffer) {
  const TextError error = *encoded("drive 600 0").what;
  std::array<char, 400> whole{};
  const std::size_t size = format_error(error, "drive 600 0", whole);
  for (std::size_t room = 0; room < size + 2; ++room) {
    const auto out = std::make_unique<char[]>(room);
    const std::size_t written = format_error(error, "drive 600 0", {out.get(), room});
    EXPECT_EQ(written, std::min(room, size));
    EXPECT_EQ(std::string_view(out.get(), written), std::string_view(whole.data(), written));
  }
}

TEST(EncodeText, IsSafeForRandomTexts) {
  std::mt19937 random{5};
  const std::vector<std::string_view> pieces{
      "drive",        "script",        "{",     "}",  ";",    "\n",     " ",         " 60:32",
      "song",         " 0x",           " -1",   "#",  ",",    ":",      "stream",    " none",
      " distance",    " 999999999999", "bytes", "\t", "leds", " play,", " straight", "tune",
      " 0 x:b=120:c,"};
  std::size_t good = 0;
  for (int i = 0; i < 100000; ++i) {
    std::string text;
    for (auto n = random() % 12; n > 0; --n) text += pieces[random() % pieces.size()];
    const Beyond beyond = i % 2 == 0 ? Beyond::nothing : Beyond::manual;
    if (encode_with_room(text, random() % 40, beyond).error.empty()) ++good;
  }
  EXPECT_GT(good, 1000U);
}

}  // namespace
}  // namespace cargobay::oi
