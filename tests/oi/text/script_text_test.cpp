#include "oi/text/script_text.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "oi/encode.hpp"
#include "oi/parse.hpp"

namespace cargobay::oi {
namespace {

using Bytes = std::vector<std::uint8_t>;

Script script_of(const Bytes& body) {
  Script script;
  EXPECT_TRUE(script.body.append(body));
  return script;
}

std::string script_text_of(const Script& script) {
  const ScriptText text = disassemble(script);
  return {text.begin(), text.end()};
}
std::string script_text_of(const Bytes& body) { return script_text_of(script_of(body)); }

// The bytes as they are sent, or none.
Bytes sent(std::string_view text) {
  Script script;
  if (compile(text, script)) return {};
  const auto bytes = encode(script);
  return {bytes->begin(), bytes->end()};
}

std::string complaint(std::string_view text) {
  Script script;
  const auto error = compile(text, script);
  if (!error) return "none";
  std::array<char, 400> line{};
  return {line.data(), format_error(*error, text, line)};
}

// What must hold for any body: its text gives the same bytes, and is its own canonical form.
void check_inverse(const Bytes& body) {
  const Script script = script_of(body);
  const std::string text = script_text_of(script);
  Script compiled = script_of({1, 2, 3});
  ASSERT_FALSE(compile(text, compiled)) << complaint(text) << " in\n" << text;
  ASSERT_EQ(Bytes(compiled.body.begin(), compiled.body.end()), body) << text;
  EXPECT_EQ(script_text_of(compiled), text);
}

struct ScriptExample {
  std::string_view text;
  Bytes bytes;  // as sent
};

// OI p. 15, literally.
const std::vector<ScriptExample>& examples() {
  static const std::vector<ScriptExample> kAll{
      {"drive 300 straight\nwait_distance 400\ndrive 0 0\n",
       {152, 13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0}},
      {"wait_event bump\nwait_event no_bump\nleds play 0 0\n"
       "wait_event bump\nwait_event no_bump\nleds none 0 0\nplay_script\n",
       {152, 17, 158, 5, 158, 251, 139, 2, 0, 0, 158, 5, 158, 251, 139, 0, 0, 0, 153}},
      {"drive 300 straight\nwait_distance 400\ndrive 300 counter_clockwise\nwait_angle 90\n"
       "play_script\n",
       {152, 17, 137, 1, 44, 128, 0, 156, 1, 144, 137, 1, 44, 0, 1, 157, 0, 90, 153}},
  };
  return kAll;
}

TEST(ScriptText, CompilesTheManualsExamples) {
  for (const ScriptExample& example : examples()) EXPECT_EQ(sent(example.text), example.bytes);
}

TEST(ScriptText, DisassemblesTheManualsExamples) {
  for (const ScriptExample& example : examples()) {
    const auto script = parse<Script>(example.bytes);
    ASSERT_TRUE(script);
    EXPECT_EQ(script_text_of(*script), example.text);
  }
}

TEST(ScriptText, TakesTheNumbersOfTheManual) {
  EXPECT_EQ(sent("wait_event 5; wait_event -5; leds 2 0 0; wait_event 5; wait_event -5; "
                 "leds 0 0 0; play_script"),
            examples()[1].bytes);
}

TEST(ScriptText, SeparatesByLinesAndSemicolonsAndPassesOverComments) {
  EXPECT_EQ(sent("# forward\r\n\r\n;; drive 300 straight ;wait_distance 400#m\n"), Bytes{});
  EXPECT_EQ(sent("# forward; drive 1 2\r\n\r\n;; \tdrive 300 straight ;wait_distance 400 #; x\r\n"
                 "   drive  0\t0;#"),
            examples()[0].bytes);
}

TEST(ScriptText, OfNothingIsTheEmptyScript) {
  for (const std::string_view text : {"", "\n", " \t\r\n;;", "# nothing", "#"}) {
    EXPECT_EQ(sent(text), (Bytes{152, 0})) << text;
  }
  EXPECT_EQ(script_text_of(Bytes{}), "");
}

TEST(ScriptText, TakesBytesAsTheyAre) {
  EXPECT_EQ(sent("bytes 1 2 255 0\nbytes 0x99"), (Bytes{152, 5, 1, 2, 255, 0, 153}));
  EXPECT_EQ(sent("bytes 152 1 153"), (Bytes{152, 3, 152, 1, 153}));
}

TEST(ScriptText, WritesWhatIsNoCommandAsBytes) {
  EXPECT_EQ(script_text_of({0}), "bytes 0\n");
  EXPECT_EQ(script_text_of({133, 146, 153, 255}), "bytes 133\nbytes 146\nplay_script\nbytes 255\n");
}

TEST(ScriptText, WritesACommandOutOfRangeAsBytes) {
  EXPECT_EQ(script_text_of({137, 1, 245, 0, 0, 153}), "bytes 137 1 245 0 0\nplay_script\n");
  EXPECT_EQ(script_text_of({158, 0}), "bytes 158 0\n");
}

TEST(ScriptText, WritesACutOffCommandAsBytes) {
  EXPECT_EQ(script_text_of({153, 137, 1, 44}), "play_script\nbytes 137 1 44\n");
  EXPECT_EQ(script_text_of({140}), "bytes 140\n");
  EXPECT_EQ(script_text_of({140, 0, 16, 60, 32}), "bytes 140 0 16 60 32\n");
}

TEST(ScriptText, WritesAStoredScriptInAScriptAsBytes) {
  EXPECT_EQ(script_text_of({152, 1, 153, 153}), "bytes 152 1 153\nplay_script\n");
  EXPECT_EQ(script_text_of({152, 0}), "bytes 152 0\n");
}

struct WrongScript {
  std::string text;
  std::size_t line;
  std::size_t column;
  std::string error;
};

TEST(ScriptText, SaysWhereAndWhatIsWrong) {
  const std::vector<WrongScript> all{
      {"drive 300 straight\n\nwait_angel 90\n", 3, 1,
       "line 3, column 1: 'wait_angel' is not a command; did you mean 'wait_angle'?"},
      {"# far\ndrive 300 straight; drive 501 0", 2, 27,
       "line 2, column 27: drive: velocity '501' is out of range; it is -500 to 500 mm/s"},
      {"drive_direct 0 -501", 1, 16,
       "column 16: drive_direct: right '-501' is out of range; it is -500 to 500 mm/s"},
      {"\n\n  wait_distance\n", 3, 16,
       "line 3, column 16: wait_distance: distance is missing; it is -32768 to 32767 mm"},
      {"play_script now", 1, 13,
       "column 13: play_script: 'now' is too much: it takes no arguments; separate commands with "
       ";"},
      {"play_script\nscript { play_script }", 2, 1,
       "line 2, column 1: a script cannot hold a script"},
      {"script", 1, 1, "column 1: a script cannot hold a script"},
      {"drive 300 straight; }", 1, 21,
       "column 21: a brace is not allowed here; only a script has braces"},
      {"bytes", 1, 1, "column 1: bytes are numbers, 0 to 255"},
      {"play_script\n bytes; bytes 1", 2, 2, "line 2, column 2: bytes are numbers, 0 to 255"},
      {"bytes 1 256", 1, 9, "column 9: bytes are numbers, 0 to 255"},
      {"bytes -1", 1, 7, "column 7: bytes are numbers, 0 to 255"},
      {"bytes 1,2", 1, 7, "column 7: bytes are numbers, 0 to 255"},
      {"bytes 1 }", 1, 9, "column 9: bytes are numbers, 0 to 255"},
      {"bytes 99999999999999999999", 1, 7, "column 7: bytes are numbers, 0 to 255"},
  };
  for (const WrongScript& wrong : all) {
    Script script = script_of({1, 2});
    const auto error = compile(wrong.text, script);
    ASSERT_TRUE(error) << wrong.text;
    EXPECT_EQ(error->line, wrong.line) << wrong.text;
    EXPECT_EQ(error->column, wrong.column) << wrong.text;
    EXPECT_EQ(complaint(wrong.text), wrong.error);
    EXPECT_EQ(script, script_of({1, 2})) << "changed by " << wrong.text;
  }
}

TEST(ScriptText, SaysWhatIsWrongWithACommand) {
  Script script;
  const auto error = compile("play_script\nwait_time 256", script);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->what, ScriptTextError::What::command);
  EXPECT_EQ(error->command.code, TextError::Code::out_of_range);
  EXPECT_EQ(error->command.position, 22U);
  ASSERT_NE(error->command.argument, nullptr);
  EXPECT_EQ(error->command.argument->max, 255);
}

std::string lines(int count, const std::string& line) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line + '\n';
  return text;
}

TEST(ScriptText, HoldsAHundredBytes) {
  const std::string full = lines(20, "drive_direct 0 0");
  EXPECT_EQ(sent(full).size(), 102U);
  const std::string text = full + "# the last straw\n  play_script";
  EXPECT_EQ(complaint(text),
            "line 22, column 3: from here on it is longer than 100 bytes, in all by 1");
}

TEST(ScriptText, NamesTheFirstLineThatDoesNotFitAndCountsToTheEnd) {
  const std::string text = lines(19, "drive_direct 0 0") + lines(1, "wait_angle 1") +
                           lines(1, "drive 0 0; play_script") + lines(2, "bytes 1 2 3");
  EXPECT_EQ(complaint(text),
            "line 21, column 1: from here on it is longer than 100 bytes, in all by 10");
}

TEST(ScriptText, CountsLinesOfBytesLikeOthers) {
  std::string text = "bytes";
  for (int i = 0; i < 103; ++i) text += " 0";
  EXPECT_EQ(complaint("\n" + text),
            "line 2, column 1: from here on it is longer than 100 bytes, in all by 3");
}

TEST(ScriptText, AMistakeComesBeforeTheLength) {
  EXPECT_EQ(complaint(lines(30, "drive_direct 0 0") + "dive"),
            "line 31, column 1: 'dive' is not a command; did you mean 'drive'?");
}

TEST(ScriptText, AQueryListLongerThanAnyScriptIsTooLong) {
  std::string text = "query_list";
  for (int i = 0; i < 255; ++i) text += " 7";
  EXPECT_EQ(complaint(text), "column 1: from here on it is longer than 100 bytes, in all by 157");
}

TEST(ScriptText, ErrorsAreCutOffWhereTheRoomEnds) {
  Script script;
  const auto error = compile("script", script);
  ASSERT_TRUE(error);
  const std::string whole = "column 1: a script cannot hold a script";
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto room = std::make_unique<char[]>(size);
    EXPECT_EQ(format_error(*error, "script", {room.get(), size}), size);
    EXPECT_EQ((std::string_view{room.get(), size}), whole.substr(0, size));
  }
}

// Every command with its smallest and largest values is a line of its own, not one of bytes: so the
// room for each byte is sufficient.
TEST(ScriptText, HasALineForEveryCommand) {
  for (const CommandInfo& info : kCommands) {
    if (info.opcode == Script::kOpcode) continue;
    for (const bool largest : {false, true}) {
      Bytes body{info.opcode};
      const auto append = [&](const ArgumentInfo& argument, std::int32_t value) {
        if (argument.size == 2) body.push_back(static_cast<std::uint8_t>(value >> 8));
        body.push_back(static_cast<std::uint8_t>(value));
      };
      std::int32_t last = 0;
      for (const ArgumentInfo& argument : info.arguments()) {
        last = largest ? argument.max : argument.min;
        if (argument.mask != 0xff) last = largest ? argument.mask : 0;
        if (info.tail == Tail::packet_ids && largest) last = std::min(last, 43);
        append(argument, last);
      }
      for (std::int32_t i = 0; info.tail != Tail::none && i < last; ++i) {
        for (const ArgumentInfo& argument : element_arguments(info.tail)) {
          append(argument, largest ? argument.max : argument.min);
        }
      }
      const std::string text = script_text_of(body);
      EXPECT_TRUE(text.starts_with(info.key)) << text;
      check_inverse(body);
    }
  }
}

// All packets one by one: the longest names.
TEST(ScriptText, HasALineForEveryPacket) {
  for (std::uint8_t id = 0; id <= 42; ++id) {
    for (const Bytes& body : {Bytes{142, id}, Bytes{148, 1, id}, Bytes{149, 3, id, id, id}}) {
      EXPECT_FALSE(script_text_of(body).starts_with("bytes")) << script_text_of(body);
      check_inverse(body);
    }
  }
}

TEST(ScriptText, RoundTripsEveryBodyOfOneAndTwoBytes) {
  for (unsigned first = 0; first < 256; ++first) {
    check_inverse({static_cast<std::uint8_t>(first)});
    for (unsigned second = 0; second < 256; ++second) {
      check_inverse({static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(second)});
      if (HasFailure()) return;
    }
  }
}

class RandomBody {
 public:
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_() >> 24U); }
  std::size_t below(std::size_t limit) { return random_() % limit; }

  Bytes noise() {
    Bytes body(below(kMaxScriptBytes + 1));
    for (std::uint8_t& each : body) each = byte();
    return body;
  }
  // Opcodes of the manual followed by any data: mostly commands, some out of range.
  Bytes commands() {
    Bytes body;
    while (body.size() < kMaxScriptBytes) {
      const CommandInfo& info = kCommands[below(kCommands.size())];
      body.push_back(info.opcode);
      for (std::size_t i = 0; i < info.argument_bytes(); ++i) {
        body.push_back(below(3) == 0 ? byte() : static_cast<std::uint8_t>(below(2)));
      }
      if (below(16) == 0) break;
    }
    body.resize(std::min(body.size(), kMaxScriptBytes));
    return body;
  }
  // A command in range.
  Bytes valid() {
    for (;;) {
      const Bytes bytes = commands();
      const ParseResult result = parse_command(bytes);
      if (result.outcome != ParseResult::Outcome::command) continue;
      if (bytes[0] == Script::kOpcode) continue;
      return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(result.length)};
    }
  }

 private:
  std::mt19937 random_{2006};
};

TEST(ScriptText, RoundTripsAnyBytes) {
  RandomBody random;
  for (int i = 0; i < 2000 && !HasFailure(); ++i) check_inverse(random.noise());
}

TEST(ScriptText, RoundTripsAnyCommands) {
  RandomBody random;
  for (int i = 0; i < 2000 && !HasFailure(); ++i) check_inverse(random.commands());
}

// No `bytes` if every command is valid: a line for each, in the order of the bytes.
TEST(ScriptText, WritesValidScriptsInCommandsOnly) {
  RandomBody random;
  for (int i = 0; i < 1000 && !HasFailure(); ++i) {
    Bytes body;
    std::size_t count = 0;
    for (;; ++count) {
      const Bytes command = random.valid();
      if (body.size() + command.size() > kMaxScriptBytes) break;
      body.insert(body.end(), command.begin(), command.end());
    }
    const std::string text = script_text_of(body);
    EXPECT_EQ(text.find("bytes"), std::string::npos) << text;
    EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), count) << text;
    check_inverse(body);
  }
}

// Truncated or garbled text compiles or is refused at the right place; what compiles has a text.
TEST(ScriptText, GarbledTextsAreHarmless) {
  RandomBody random;
  constexpr std::string_view kLikely = "#;{}\n \t-0123456789abcdefxbytesript,:_";
  for (int i = 0; i < 4000 && !HasFailure(); ++i) {
    std::string text{examples()[random.below(3)].text};
    text.resize(text.size() - random.below(20));
    for (std::size_t changes = random.below(4); changes > 0; --changes) {
      text[random.below(text.size())] = random.below(3) == 0
                                            ? static_cast<char>(random.byte())
                                            : kLikely[random.below(kLikely.size())];
    }
    const std::vector<char> exact(text.begin(), text.end());
    Script script;
    const auto error = compile({exact.data(), exact.size()}, script);
    if (!error) {
      check_inverse({script.body.begin(), script.body.end()});
    } else {
      EXPECT_TRUE(script.body.empty());
      const auto new_lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
      EXPECT_LE(error->line, new_lines + 1);
      EXPECT_LE(error->column, text.size() + 1);
      EXPECT_NE(complaint(text), "");
    }
  }
}

}  // namespace
}  // namespace cargobay::oi
