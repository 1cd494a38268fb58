// The commands that need no robot: encode, decode, budget.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pty/tools_process.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;

using Words = std::vector<std::string>;

Outcome encode(Words words, const std::string& input = "") {
  words.insert(words.begin(), "encode");
  return run_tool(words, input);
}
Outcome decode(Words words, const std::string& input = "") {
  words.insert(words.begin(), "decode");
  return run_tool(words, input);
}

TEST(EncodeTool, PrintsTheManualsExamples) {
  const auto bytes = [](const Words& words) {
    const Outcome outcome = encode(words);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.error, "");
    return outcome.out;
  };
  EXPECT_EQ(bytes({"drive", "-200", "500"}), "89 ff 38 01 f4\n");
  EXPECT_EQ(bytes({"drive_direct", "100", "-100"}), "91 ff 9c 00 64\n");
  EXPECT_EQ(bytes({"stream", "29", "13"}), "94 02 1d 0d\n");
  EXPECT_EQ(bytes({"wait_event", "-5"}), "9e fb\n");
  EXPECT_EQ(bytes({"leds", "advance", "0", "128"}), "8b 08 00 80\n");
  EXPECT_EQ(bytes({"pwm_low_side_drivers", "128", "0", "32"}), "90 20 00 80\n");
  EXPECT_EQ(bytes({"song", "0", "60:32", "64:32"}), "8c 00 02 3c 20 40 20\n");
  EXPECT_EQ(bytes({"script { drive 300 straight; wait_distance 400; drive 0 0 }"}),
            "98 0d 89 01 2c 80 00 9c 01 90 89 00 00 00 00\n");
  EXPECT_EQ(bytes({"safe; drive_direct 1 2;", "full"}), "83 91 00 02 00 01 84\n");
}

TEST(EncodeTool, TakesCommandsNamedAsItsOwnSubcommands) {
  EXPECT_EQ(encode({"sensors", "6"}).out, "8e 06\n");
  EXPECT_EQ(encode({"drive", "0", "0"}).out, "89 00 00 00 00\n");
}

TEST(EncodeTool, TakesADoubleDashBeforeTheText) {
  EXPECT_EQ(encode({"--", "drive", "-200", "500"}).out, "89 ff 38 01 f4\n");
  EXPECT_EQ(decode({"--", "83"}).code, 0);
}

TEST(EncodeTool, ReadsStandardInput) {
  EXPECT_EQ(encode({}, "safe\n# slow\ndrive_direct 10 10\n").out, "83 91 00 0a 00 0a\n");
  EXPECT_EQ(encode({"-"}, "full").out, "84\n");
}

TEST(EncodeTool, WritesRawBytes) {
  EXPECT_EQ(encode({"--binary", "drive", "-200", "500"}).out,
            std::string("\x89\xff\x38\x01\xf4", 5));
  EXPECT_EQ(encode({"sensors", "0", "--binary"}).out, std::string("\x8e\0", 2));
}

TEST(EncodeTool, PointsAtWhatIsWrong) {
  const Outcome outcome = encode({"safe;", "drive", "600", "0"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.error,
            "cargobay: error: column 13: drive: velocity '600' is out of range; it is -500 to 500 "
            "mm/s\n"
            "  safe; drive 600 0\n"
            "              ^^^\n");
  EXPECT_EQ(encode({}, "safe\n\tdrvie 1 2\n").error,
            "cargobay: error: line 2, column 2: 'drvie' is not a command; did you mean 'drive'?\n"
            "   drvie 1 2\n"
            "   ^^^^^\n");
}

TEST(EncodeTool, RefusesNothingAndUnknownOptions) {
  EXPECT_EQ(encode({}, "").code, 1);
  EXPECT_THAT(encode({}, "# nothing\n").error, HasSubstr("there is no command in the text"));
  const Outcome option = encode({"--binar", "safe"});
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.error, HasSubstr("encode has no option --binar; did you mean --binary? see: "
                                      "cargobay encode --help"));
}

TEST(DecodeTool, SaysWhatCommandsMean) {
  const Outcome outcome = decode({"89", "ff", "38", "01", "f4"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out,
            "    0  89                 Drive (OI p. 9)\n"
            "    1  ff 38              velocity -200 mm/s\n"
            "    3  01 f4              radius 500 mm\n"
            "                          = drive -200 500\n");
  EXPECT_EQ(outcome.error, "cargobay: read as commands to the robot (--from host)\n");
}

TEST(DecodeTool, TakesBytesInAnyUsualSpelling) {
  const std::string expected = decode({"83", "8e", "06"}).out;
  for (const Words& words :
       {Words{"838e06"}, Words{"838E", "06"}, Words{"0x83,0x8e,0x6"}, Words{"[83][8e][06]"},
        Words{"83:8e:06"}, Words{R"(\x83\x8e\x06)"}, Words{"--decimal", "131", "142", "6"},
        Words{"--decimal", "[131] [-114] [6]"}}) {
    EXPECT_EQ(decode(words).out, expected) << words.back();
  }
  EXPECT_EQ(decode({}, "83\n8e06\n").out, expected);
  EXPECT_EQ(decode({"--binary", "-"}, "\x83\x8e\x06").out, expected);
}

TEST(DecodeTool, SaysWhatTheRobotsStreamMeans) {
  const Outcome outcome = decode({"--decimal", "19", "5", "29", "2", "25", "13", "0", "182"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.error, HasSubstr("read as bytes from the robot (--from robot)"));
  EXPECT_THAT(outcome.out, HasSubstr("    3  02 19              cliff_front_left_signal 537\n"));
  EXPECT_THAT(decode({"--decimal", "19 5 29 2 25 13 0 1"}).out,
              HasSubstr("! wrong checksum: a3 would be right"));
}

TEST(DecodeTool, TakesTheSideThatIsAskedFor) {
  const Outcome outcome = decode({"--from", "robot", "89", "ff"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("! outside any frame"));
  EXPECT_THAT(outcome.error, testing::Not(HasSubstr("read as")));
  EXPECT_EQ(decode({"--from", "stream", "89", "ff"}).out, outcome.out);
  EXPECT_THAT(decode({"--from", "command", "13"}).out, HasSubstr("19 is not a command"));
  EXPECT_NE(decode({"--from", "nobody", "13"}).code, 0);
}

TEST(DecodeTool, DecodesAReply) {
  const Outcome outcome = decode({"--packets", "distance,7", "ff", "fe", "02"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out,
            "    0  ff fe              distance -2 mm\n"
            "    2  02                 bumps_and_wheel_drops 2 (bump_left)\n");
  EXPECT_THAT(decode({"--packets", "nonsense", "00"}).error,
              HasSubstr("'nonsense' is not a packet"));
}

TEST(DecodeTool, SaysHowManyBytesAreMissing) {
  const Outcome outcome = decode({"83", "89", "ff"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("    3                     ! needs 3 more bytes\n"));
  EXPECT_THAT(outcome.error, HasSubstr("the bytes end too early: 3 more bytes needed"));
}

TEST(DecodeTool, RefusesWhatIsNoByte) {
  const auto error = [](const Words& words) {
    const Outcome outcome = decode(words);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.out, "");
    return outcome.error;
  };
  EXPECT_THAT(error({"137", "255"}), HasSubstr("ask for decimal with --decimal"));
  EXPECT_THAT(error({"8g"}), HasSubstr("'8g' is not a byte in hexadecimal"));
  EXPECT_THAT(error({"--decimal", "256"}), HasSubstr("'256' is not a byte"));
  EXPECT_THAT(error({"--binary", "/nowhere/at/all"}), HasSubstr("cannot read /nowhere/at/all"));
  EXPECT_THAT(error({}), HasSubstr("there are no bytes"));
}

TEST(DecodeTool, PrintsTextThatEncodeTakes) {
  const std::string text = decode({"--text", "83", "89", "ff", "38", "01", "f4"}).out;
  EXPECT_EQ(text, "safe\ndrive -200 500\n");
  EXPECT_EQ(encode({}, text).out, "83 89 ff 38 01 f4\n");
}

TEST(BudgetTool, SaysWhetherAStreamFits) {
  const Outcome fits = run_tool({"budget", "--baud", "57600", "--packets", "6"});
  EXPECT_EQ(fits.code, 0);
  EXPECT_THAT(fits.out, HasSubstr("56 bytes"));
  EXPECT_THAT(fits.out, HasSubstr("86 bytes"));
  EXPECT_EQ(fits.error, "");
  const Outcome too_much = run_tool({"budget", "--baud", "19200", "--packets", "6"});
  EXPECT_EQ(too_much.code, 1);
  EXPECT_THAT(too_much.out, HasSubstr("28 bytes"));
  EXPECT_THAT(too_much.error, HasSubstr("56 bytes do not fit"));
}

TEST(BudgetTool, RefusesWhatTheRobotDoesNotHave) {
  const Outcome baud = run_tool({"budget", "--baud", "12345"});
  EXPECT_EQ(baud.code, 1);
  EXPECT_THAT(baud.error, HasSubstr("the robot does not support 12345 baud"));
  const Outcome packet = run_tool({"budget", "--packets", "43"});
  EXPECT_EQ(packet.code, 1);
  EXPECT_THAT(packet.error, HasSubstr("'43' is not a packet"));
}

TEST(Tool, RefusesUnknownSubcommandsAndOptions) {
  EXPECT_EQ(run_tool({"fly"}).code, 2);
  EXPECT_EQ(run_tool({"budget", "--fast"}).code, 2);
  EXPECT_EQ(run_tool({"send", "--fast", "safe"}).code, 2);
  EXPECT_EQ(run_tool({"encode", "--help"}).code, 0);
}

}  // namespace
}  // namespace cargobay::test
