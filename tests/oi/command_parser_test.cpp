#include "oi/command_parser.hpp"

#include <random>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "oi/parse.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {
namespace {

using CommandOutcome = CommandParser::Outcome;

std::vector<Bytes> commands_in(CommandParser& parser, const Bytes& bytes) {
  std::vector<Bytes> commands;
  for (const std::uint8_t byte : bytes) {
    if (parser.push(byte) == CommandOutcome::command) {
      commands.emplace_back(parser.bytes().begin(), parser.bytes().end());
    }
  }
  return commands;
}

TEST(CommandParser, AnswersForAllOpcodes) {
  for (unsigned opcode = 0; opcode < 256; ++opcode) {
    CommandParser parser;
    const CommandOutcome outcome = parser.push(static_cast<std::uint8_t>(opcode));
    const CommandInfo* info = kCreate.find_command(static_cast<std::uint8_t>(opcode));
    if (info == nullptr) {
      EXPECT_EQ(outcome, CommandOutcome::unknown_opcode) << opcode;
      EXPECT_EQ(parser.needed(), 0U);
      EXPECT_EQ(parser.bytes().size(), 1U);
    } else {
      EXPECT_EQ(outcome,
                info->argument_bytes() == 0 ? CommandOutcome::command : CommandOutcome::incomplete)
          << opcode;
      EXPECT_EQ(parser.needed(), info->argument_bytes());
      EXPECT_EQ(&parser.info(), info);
    }
  }
}

TEST(CommandParser, DividesARowOfCommands) {
  CommandParser parser;
  const std::vector<Bytes> row{{128},    {132}, {137, 255, 56, 1, 244}, {148, 2, 29, 13},
                               {152, 0}, {153}};
  Bytes bytes;
  for (const Bytes& command : row) bytes = bytes + command;
  EXPECT_EQ(commands_in(parser, bytes), row);
}

TEST(CommandParser, PassesOverUnknownOpcodes) {
  CommandParser parser;
  EXPECT_EQ(commands_in(parser, {0, 127, 173, 128, 255, 131}), (std::vector<Bytes>{{128}, {131}}));
}

TEST(CommandParser, TakesWhatFollowsAHalfSentCommandAsItsData) {
  CommandParser parser;
  EXPECT_EQ(commands_in(parser, {137, 0, 200, 128, 128}),
            (std::vector<Bytes>{{137, 0, 200, 128, 128}}));
}

TEST(CommandParser, SaysHowManyBytesAreNeededAtLeast) {
  CommandParser parser;
  EXPECT_EQ(parser.needed(), 0U);
  (void)parser.push(140);
  EXPECT_EQ(parser.needed(), 2U);
  (void)parser.push(0);
  EXPECT_EQ(parser.needed(), 1U);
  (void)parser.push(2);
  EXPECT_EQ(parser.needed(), 4U);
  for (const std::uint8_t byte : Bytes{60, 32, 64})
    EXPECT_EQ(parser.push(byte), CommandOutcome::incomplete);
  EXPECT_EQ(parser.needed(), 1U);
  EXPECT_EQ(parser.push(32), CommandOutcome::command);
  EXPECT_EQ(parser.needed(), 0U);
}

TEST(CommandParser, SwallowsTheLongestTailsWhole) {
  for (const std::uint8_t opcode : Bytes{148, 149, 152}) {
    CommandParser parser;
    Bytes bytes(2 + 255, 128);
    bytes[0] = opcode;
    bytes[1] = 255;
    EXPECT_EQ(commands_in(parser, bytes), (std::vector<Bytes>{bytes}));
    EXPECT_EQ(commands_in(parser, {131}), (std::vector<Bytes>{{131}}));
  }
  CommandParser parser;
  Bytes song(CommandParser::kMostBytes, 128);
  song[0] = 140;
  song[2] = 255;
  EXPECT_EQ(commands_in(parser, song), (std::vector<Bytes>{song}));
  EXPECT_EQ(commands_in(parser, {131}), (std::vector<Bytes>{{131}}));
}

TEST(CommandParser, TakesALengthOfZeroForTheWholeCommand) {
  CommandParser parser;
  EXPECT_EQ(commands_in(parser, {148, 0, 140, 5, 0, 152, 0, 149, 0}),
            (std::vector<Bytes>{{148, 0}, {140, 5, 0}, {152, 0}, {149, 0}}));
}

TEST(CommandParser, ForgetsACommandUnderWay) {
  CommandParser parser;
  (void)parser.push(137);
  parser.reset();
  EXPECT_EQ(parser.needed(), 0U);
  EXPECT_EQ(commands_in(parser, {131}), (std::vector<Bytes>{{131}}));
}

// Both read the same bytes the same way, wherever they are cut.
TEST(CommandParser, AgreesWithParseCommandOnRandomBytes) {
  std::mt19937 random{1};
  Bytes bytes(200000);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random() % 3 == 0 ? 128 + random() % 31 : random());
  }
  CommandParser parser;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const CommandOutcome outcome = parser.push(bytes[i]);
    const ParseResult result = parse_command(std::span{bytes}.subspan(begin, i + 1 - begin));
    if (outcome == CommandOutcome::incomplete) {
      ASSERT_EQ(result.outcome, ParseResult::Outcome::incomplete);
      ASSERT_EQ(result.needed, parser.needed());
      continue;
    }
    ASSERT_EQ(outcome == CommandOutcome::unknown_opcode,
              result.outcome == ParseResult::Outcome::unknown_opcode);
    ASSERT_EQ(result.length, parser.bytes().size());
    begin = i + 1;
  }
}

}  // namespace
}  // namespace cargobay::oi
