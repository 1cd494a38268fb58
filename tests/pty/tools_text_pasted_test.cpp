// What `decode` takes as it is pasted: dumps, literals, tables of logic analysers. The texts are
// those that the programs print.
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pty/tools_process.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// drive -200 500; safe; drive_direct 100 100; sensors group_6; stream distance pause
constexpr const char* kPlain = "89ff3801f4 8391 00640064 8e06 94021323";

Outcome pasted(const std::string& text, std::vector<std::string> words = {}) {
  words.insert(words.begin(), {"decode", "--from", "host"});
  return run_tool(words, text);
}

struct Form {
  std::string name;
  std::string text;
};

const std::vector<Form> kForms{
    {"xxd",
     "00000000: 89ff 3801 f483 9100 6400 648e 0694 0213  ..8.....d.d.....\n"
     "00000010: 23                                       #\n"},
    {"xxd -g1 -u",
     "00000000: 89 FF 38 01 F4 83 91 00 64 00 64 8E 06 94 02 13  ..8.....d.d.....\n"
     "00000010: 23                                               #\n"},
    {"xxd -b",
     "00000000: 10001001 11111111 00111000 00000001 11110100 10000011  ..8...\n"
     "00000006: 10010001 00000000 01100100 00000000 01100100 10001110  ..d.d.\n"
     "0000000c: 00000110 10010100 00000010 00010011 00100011           ....#\n"},
    {"xxd -e",
     "00000000: 0138ff89 009183f4 8e640064 13029406  ..8.....d.d.....\n"
     "00000010:       23                             #\n"},
    {"xxd -i",
     "unsigned char a_bin[] = {\n"
     "  0x89, 0xff, 0x38, 0x01, 0xf4, 0x83, 0x91, 0x00, 0x64, 0x00, 0x64, 0x8e,\n"
     "  0x06, 0x94, 0x02, 0x13, 0x23\n};\nunsigned int a_bin_len = 17;\n"},
    {"hexdump -C",
     "00000000  89 ff 38 01 f4 83 91 00  64 00 64 8e 06 94 02 13  |..8.....d.d.....|\r\n"
     "00000010  23                                                |#|\r\n"
     "00000011\r\n"},
    {"hexdump",
     "0000000 ff89 0138 83f4 0091 0064 8e64 9406 1302\n"
     "0000010 0023                                   \n"
     "0000011\n"},
    {"od",
     "0000000 177611 000470 101764 000221 000144 107144 112006 011402\n"
     "0000020 000043\n0000021\n"},
    {"od -A x",
     "000000 177611 000470 101764 000221 000144 107144 112006 011402\n000010 000043\n000011\n"},
    {"od -t x1", "0000000 89 ff 38 01 f4 83 91 00 64 00 64 8e 06 94 02 13\n0000020 23\n0000021\n"},
    {"od -A d -t x1",
     "0000000 89 ff 38 01 f4 83 91 00 64 00 64 8e 06 94 02 13\n0000016 23\n0000017\n"},
    {"od -A x -t x1z",
     "000000 89 ff 38 01 f4 83 91 00 64 00 64 8e 06 94 02 13  >..8.....d.d.....<\n"
     "000010 23                                               >#<\n000011\n"},
    {"hexdump -d",
     "0000000   65417   00312   33780   00145   00100   36452   37894   04866\n"
     "0000010   00035\n0000011\n"},
    {"xxd -d",
     "00000000: 89ff 3801 f483 9100 6400 648e 0694 0213  ..8.....d.d.....\n"
     "00000016: 23                                       #\n"},
    {"od -c",
     "0000000 211 377   8 001 364 203 221  \\0   d  \\0   d 216 006 224 002 023\n"
     "0000020   #\n0000021\n"},
    {"od -b",
     "0000000 211 377 070 001 364 203 221 000 144 000 144 216 006 224 002 023\n"
     "0000020 043\n0000021\n"},
    {"od -t u1",
     "0000000 137 255  56   1 244 131 145   0 100   0 100 142   6 148   2  19\n"
     "0000020  35\n0000021\n"},
    {"od -t d1",
     "0000000 -119   -1   56    1  -12 -125 -111    0  100    0  100 -114    6 -108    2   19\n"
     "0000020   35\n0000021\n"},
    {"od -t x4", "0000000 0138ff89 009183f4 8e640064 13029406\n0000020 00000023\n0000021\n"},
    {"Wireshark",
     "0000   89 ff 38 01 f4 83 91 00 64 00 64 8e 06 94 02 13   ..8.....d.d.....\n"
     "0010   23                                                #\n"},
    {"Python", "b'\\x89\\xff8\\x01\\xf4\\x83\\x91\\x00d\\x00d\\x8e\\x06\\x94\\x02\\x13#'\n"},
    {"Python, bytearray",
     "sent bytearray(b\"\\x89\\xff8\\x01\\xf4\\x83\\x91\\x00d\\x00d\") then "
     "b'\\x8e\\6\\224\\x02\\x13#'\n"},
    {"Python, list",
     "bytes([137, 255, 0x38, 1, 244, 131, 145, 0, 100, 0, 100, 142, 6, 148, 2, 19, 35])\n"},
    {"Python, array",
     "array('B', [137, 255, 56, 1, 244, 131, 145, 0, 100, 0, 100, 142, 6, 148, 2, 19, 35])\n"},
    {"Python, hex", "bytes.fromhex('89ff 3801f4 8391 00640064 8e06 94021323')\n"},
};

TEST(Pasted, FormsAreReadAsTheBytesThatTheyShow) {
  const std::string expected = pasted(kPlain).out;
  ASSERT_THAT(expected, HasSubstr("= stream "));
  for (const Form& form : kForms) {
    const Outcome outcome = pasted(form.text);
    EXPECT_EQ(outcome.out, expected) << form.name << ": " << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("cargobay: form: ")) << form.name;
  }
}

TEST(Pasted, TakesADumpAsOneWordOfTheCommandLine) {
  EXPECT_EQ(run_tool({"decode", kForms[0].text, "--from", "host"}).out, pasted(kPlain).out);
}

TEST(Pasted, FillsInWhatAStarStandsFor) {
  const std::string zeros(128, '0');
  const std::string expected = pasted(zeros + "83").out;
  EXPECT_EQ(
      pasted("00000000  00 00 00 00 00 00 00 00  00 00 00 00 00 00 00 00  |................|\n"
             "*\n"
             "00000040  83                                                |.|\n"
             "00000041\n")
          .out,
      expected);
  EXPECT_EQ(pasted("0000000 000000 000000 000000 000000 000000 000000 000000 000000\n"
                   "*\n0000100 000203\n0000101\n")
                .out,
            expected);
}

TEST(Pasted, RefusesOffsetsThatDoNotFit) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"00000000: 89ff 3801\n00000010: f4\n",
       "line 2: the offset 00000010 does not fit the 4 bytes"},
      {"00000010  89 ff\n00000000  38\n", "line 2: '00000000' is not the next offset"},
      {"00000000: 89ff  .8\n", "line 1: the bytes and the characters beside them differ"},
      {"00000000: 8\n", "line 1: '8' is not a value of xxd"},
      {"0000000 89 ff\nfoo\n",
       "line 2 has no offset; make the dump in one form, such as: od -t x1"},
      {"0000000 123456 7\n", "; if that is not the form, make the dump with: od -t x1"},
      {"*\n", "'*' is for lines that the dump leaves out; make it with all of them: od -v"},
      {"0000000 89 ff\n0000002\n*\n", "line 3: there is nothing to repeat"},
      {"0000000 137 255 156\n", "can be octal or decimal"},
      {"0000000 89 fg\n", "line 1: "},
      {"00000000: 8901  ..\n*\n7fffffff: 02  .\n", "line 3: the offset is too large"},
      {"b'\\x8'", "column 3: not an escape of Python's bytes"},
      {"b'\\x89", "the closing quote of Python's bytes is missing"},
      {"bytes([137, 256])", "'256' is not a byte: 0 to 255, or 0x00 to 0xff"},
      {"char x[] = { 1, 2", "the } of the array is missing"},
  };
  for (const auto& [text, error] : wrong) {
    const Outcome outcome = pasted(text);
    EXPECT_EQ(outcome.code, 1) << text;
    EXPECT_EQ(outcome.out, "") << text;
    EXPECT_THAT(outcome.error, HasSubstr(error)) << text;
  }
}

TEST(Pasted, TakesAmbiguousDigitsAsDecimalIfToldTo) {
  EXPECT_THAT(pasted("0000000 137 255 156 101 244\n", {"--decimal"}).out, HasSubstr("ff 9c"));
}

TEST(Pasted, TakesPlainBytesForNoDump) {
  for (const char* text : {"000000 112233", "0000 0000 89", "00:00:89"}) {
    EXPECT_THAT(pasted(text).error, Not(HasSubstr("form: "))) << text;
  }
}

TEST(Pasted, ReadsTablesOfSaleaeLogic) {
  const std::string expected = pasted("89 ff 38 01 f4").out;
  EXPECT_EQ(pasted("name,type,start_time,duration,data\n"
                   "\"Async Serial\",\"data\",0.1,0.00017,0x89\n"
                   "\"Async Serial\",\"data\",0.2,0.00017,0xFF\n"
                   "\"Async Serial\",\"data\",0.3,0.00017,0x0000000000000038\n"
                   "\"Async Serial\",\"data\",0.4,0.00017,0x01\n"
                   "\"Async Serial\",\"data\",0.5,0.00017,0xF4\n")
                .out,
            expected);
  EXPECT_EQ(pasted("Time [s],Value,Parity Error,Framing Error\r\n"
                   "0.1,0x89,,\r\n0.2,0xFF,,\r\n0.3,'8' (0x38),,\r\n0.4,0x01,,\r\n0.5,0xF4,,\r\n")
                .out,
            expected);
  EXPECT_EQ(pasted("Time [s],Value,Parity Error,Framing Error\n"
                   "0.1,137,,\n0.2,255,,\n0.3,56,,\n0.4,1,,\n0.5,244,,\n")
                .out,
            expected);
  EXPECT_EQ(pasted("Time [s];Value\n0.1;\\x89\n0.2;\\xff\n0.3;8\n0.4;\\x01\n0.5;\\xF4\n").out,
            expected)
      << "a digit among characters is one";
  EXPECT_THAT(pasted("Time [s],Value\n0.1,0x89\n0.2,hello\n").error,
              HasSubstr("line 3: 'hello' is not a byte"));
}

TEST(Pasted, ReadsAnnotationsOfSigrok) {
  const std::string expected = pasted("89 ff").out;
  EXPECT_EQ(pasted("uart-1: 89\nuart-1: FF\n").out, expected);
  EXPECT_EQ(pasted("518-657 uart-1: Start bit\n518-657 uart-1: 1\n518-657 uart-1: 89\n"
                   "658-659 uart-1: Stop bit\n692-831 uart-1: FF\n")
                .out,
            expected);
  EXPECT_THAT(pasted("uart-1: 89\nspi-1: hello\n").error,
              HasSubstr("line 2: 'spi-1: hello' is not a byte of a sigrok decoder"));
}

TEST(Pasted, DecodesEachLineOfAnAnalyser) {
  const std::string both =
      "518-657 UART: TX: 8E\n692-831 UART: TX: 23\n3000-3100 UART: RX: 13\n"
      "3200-3300 UART: RX: 02\n3400-3500 UART: RX: 23\n3600-3700 UART: RX: 02\n"
      "3800-3900 UART: RX: C6\n";
  const Outcome outcome = run_tool({"decode"}, both);
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("= sensors oi_mode\n"));
  EXPECT_THAT(outcome.out, HasSubstr("oi_mode 2 (safe)\n"));
  EXPECT_THAT(outcome.error, HasSubstr("line UART: RX:\ncargobay: read as bytes from the robot"));
  const Outcome one = run_tool({"decode", "--line", "TX"}, both);
  EXPECT_THAT(one.out, HasSubstr("= sensors oi_mode\n"));
  EXPECT_THAT(one.out, Not(HasSubstr("header")));
}

// The levels of a line that sends these bytes at 57600 baud, sampled at 1 MHz.
std::vector<bool> levels_of(const std::vector<unsigned>& bytes) {
  std::vector<bool> bits(5, true);
  for (const unsigned byte : bytes) {
    bits.push_back(false);
    for (unsigned bit = 0; bit < 8; ++bit) bits.push_back((byte >> bit & 1U) != 0);
    bits.push_back(true);
  }
  bits.resize(bits.size() + 5, true);
  std::vector<bool> levels;
  for (std::size_t i = 0; i * 57600 / 1'000'000 < bits.size(); ++i)
    levels.push_back(bits[i * 57600 / 1'000'000]);
  return levels;
}

TEST(Pasted, ReadsSamplesOfALine) {
  const std::vector<bool> levels = levels_of({0x89, 0xff, 0x38, 0x01, 0xf4});
  std::string sigrok =
      "; CSV generated by libsigrok 0.5.2\n; Channels (2/2): RX, TX\nMETA samplerate: 1000000\n"
      "logic,logic\n";
  std::string saleae = "Time [s],RX,TX\n-0.5,1,1\n";
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string level = levels[i] ? "1" : "0";
    sigrok += "1," + level + "\n";
    // Only where it changes.
    if (i > 0 && levels[i] != levels[i - 1])
      saleae += std::to_string(static_cast<double>(i) * 1e-6) + ",1," + level + "\n";
  }
  const std::string expected = pasted("89 ff 38 01 f4").out;
  for (const std::string& text : {sigrok, saleae}) {
    EXPECT_EQ(pasted(text).out, expected);
    EXPECT_THAT(pasted(text, {"--baud", "115200"}).error, HasSubstr("is another --baud right"));
    EXPECT_THAT(pasted(text + "1\n").error, HasSubstr("'1' is not a row of samples"));
  }
  EXPECT_THAT(pasted("Time [s],RX\n0.1,1\n0.2,1\n").error,
              HasSubstr("no line of the samples has a byte at 57600 baud"));
  EXPECT_THAT(pasted("; CSV generated by libsigrok 0.5.2\nlogic\n1\n").error,
              HasSubstr("the samples have no samplerate"));
}

// As sigrok 0.5.2 writes a capture: the rate in its header, and a column of time, which PulseView
// always has.
TEST(Pasted, ReadsTheHeaderAndTheTimesOfSigrok) {
  const std::vector<bool> levels = levels_of({0x89, 0xff, 0x38, 0x01, 0xf4});
  const std::string header =
      "; CSV generated by libsigrok 0.5.2\n; from Demo driver on Mon Nov 30 09:26:41 2026\n"
      "; Channels (2/8): TX, RX\n; Samplerate: ";
  std::string without = header + "1 MHz\nlogic,logic\n";
  std::string with = header + "1 MHz\nmicroseconds,logic,logic\n";
  std::string changes = header + "1 MHz\nTime,TX,RX\n";
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string row = std::string{levels[i] ? "1" : "0"} + ",1\n";
    const std::string time = std::to_string(i + 1) + ",";
    without += row;
    with += time + row;
    if (i == 0 || levels[i] != levels[i - 1]) changes += time + row;
  }
  const std::string expected = pasted("89 ff 38 01 f4").out;
  for (const std::string& text : {without, with, changes}) {
    EXPECT_EQ(pasted(text).out, expected) << text.substr(0, 200);
    EXPECT_EQ(pasted(text, {"--line", "TX"}).out, expected);
  }
  EXPECT_THAT(pasted(header + "0 Hz\nlogic\n1\n").error, HasSubstr("have no samplerate"));
}

// At 700 kHz a sample takes 1.43 us, and sigrok counts 1.
TEST(Pasted, ReadsTimesOfSigrokThatAreCutOff) {
  const std::vector<bool> levels = levels_of({0x89, 0xff, 0x38, 0x01, 0xf4});
  std::string text =
      "; CSV generated by libsigrok 0.5.2\n; Channels (1/8): TX\n; Samplerate: 700 kHz\n"
      "microseconds,logic\n";
  for (std::size_t i = 0; i * 10 / 7 < levels.size(); ++i) {
    text += std::to_string(i + 1) + (levels[i * 10 / 7] ? ",1\n" : ",0\n");
  }
  EXPECT_EQ(pasted(text).out, pasted("89 ff 38 01 f4").out);
}

TEST(Decode, TakesOpcodesOfOtherRobotsForCommands) {
  EXPECT_THAT(run_tool({"decode", "--decimal", "173"}).out, HasSubstr("have it: Stop"));
  EXPECT_THAT(run_tool({"decode", "--decimal", "133"}).out, HasSubstr("have it: Power"));
  EXPECT_THAT(run_tool({"decode", "7"}).out, HasSubstr("only of some robots: restarts the robot"));
  EXPECT_THAT(run_tool({"decode", "00", "10"}).error, HasSubstr("name its packets: --packets"));
}

TEST(Decode, NamesAFrameOfTheCreate2) {
  const Outcome outcome = run_tool({"decode", "13 07 2b 01 02 23 02 2d 07 5f"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("! packet 43 Left Encoder Counts of the Create 2"));
  EXPECT_THAT(outcome.out, HasSubstr("oi_mode 2 (safe)"));
}

TEST(Decode, KnowsExtensionsIfAsked) {
  EXPECT_EQ(run_tool({"decode", "--extensions", "07", "08"}).code, 0);
  EXPECT_THAT(
      run_tool({"decode", "--extensions", "--packets", "43,raw_right_count", "01020304"}).out,
      HasSubstr("raw_right_count 772"));
  EXPECT_THAT(run_tool({"decode", "--extensions", "12 07 09 18 12 05 13"}).out,
              HasSubstr("firmware of 2007-09-24 18:05"));
  EXPECT_THAT(run_tool({"decode", "--packets", "43", "0102"}).error,
              HasSubstr("'43' is not a packet; write numbers from 0 to 42"));
}

}  // namespace
}  // namespace cargobay::test
