#include "oi/parse.hpp"

#include <algorithm>
#include <memory>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {
namespace {

using ParseOutcome = ParseResult::Outcome;

// What must hold for any bytes at all. Returns the outcome.
ParseOutcome check(const Bytes& bytes) {
  // Allocated to exactly its size, so that a sanitizer sees a read past the end.
  const auto exact = std::make_unique<std::uint8_t[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), exact.get());
  const ParseResult result = parse_command({exact.get(), bytes.size()});
  switch (result.outcome) {
    case ParseOutcome::command: {
      const auto encoded = encode(result.command);
      EXPECT_TRUE(encoded.has_value());
      EXPECT_EQ(Bytes(encoded->begin(), encoded->end()),
                Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(result.length)));
      break;
    }
    case ParseOutcome::incomplete:
      EXPECT_GT(result.needed, 0U);
      EXPECT_EQ(result.length, 0U);
      break;
    case ParseOutcome::unknown_opcode:
      EXPECT_EQ(kCreate.find_command(bytes[0]), nullptr);
      EXPECT_EQ(result.length, 1U);
      break;
    case ParseOutcome::out_of_range:
      EXPECT_NE(result.error.argument, nullptr);
      EXPECT_FALSE(result.error.argument->accepts(result.error.value));
      EXPECT_EQ(number_at(std::span{bytes}.subspan(result.error.offset), *result.error.argument),
                result.error.value);
      EXPECT_LE(result.length, bytes.size());
      break;
  }
  return result.outcome;
}

TEST(ParseCommand, AnswersForAllOpcodes) {
  for (unsigned opcode = 0; opcode < 256; ++opcode) {
    const auto byte = static_cast<std::uint8_t>(opcode);
    const ParseResult result = parse_command(Bytes{byte});
    EXPECT_EQ(result.info, kCreate.find_command(byte));
    if (result.info == nullptr) {
      EXPECT_EQ(result.outcome, ParseOutcome::unknown_opcode);
    } else if (result.info->argument_bytes() == 0) {
      EXPECT_EQ(result.outcome, ParseOutcome::command);
    } else {
      EXPECT_EQ(result.outcome, ParseOutcome::incomplete);
      EXPECT_EQ(result.needed, result.info->argument_bytes());
    }
  }
}

TEST(ParseCommand, RoundTripsEveryValueOfShortCommands) {
  for (const CommandInfo& info : kCommands) {
    if (info.argument_bytes() == 0) {
      EXPECT_EQ(check({info.opcode}), ParseOutcome::command);
    }
    if (info.tail != Tail::none || info.argument_bytes() > 2) continue;
    const bool two = info.argument_bytes() == 2;
    for (unsigned first = 0; first < 256; ++first) {
      for (unsigned second = 0; second < (two ? 256U : 1U); ++second) {
        Bytes bytes{info.opcode, static_cast<std::uint8_t>(first)};
        if (two) bytes.push_back(static_cast<std::uint8_t>(second));
        (void)check(bytes);
      }
    }
  }
}

TEST(ParseCommand, RoundTripsRandomLongCommands) {
  std::mt19937 random{1};
  std::set<std::pair<int, ParseOutcome>> seen;
  for (int i = 0; i < 300000; ++i) {
    const CommandInfo& info = kCommands[random() % kCommandCount];
    Bytes bytes{info.opcode};
    const bool small = random() % 2 == 0;  // otherwise hardly any speed would be in range
    while (bytes.size() < 1 + info.argument_bytes()) {
      bytes.push_back(static_cast<std::uint8_t>(
          small && bytes.size() % 2 == 1 ? (random() % 2 == 0 ? 0 : 255) : random()));
    }
    if (info.tail != Tail::none) {
      bytes.back() = static_cast<std::uint8_t>(random() % (random() % 8 == 0 ? 256 : 20));
      const std::size_t tail = bytes.back() * element_size(info.tail);
      const unsigned most = random() % 4 == 0 ? 256 : 43;
      for (std::size_t k = 0; k < tail; ++k)
        bytes.push_back(static_cast<std::uint8_t>(random() % most));
    }
    seen.insert({info.opcode, check(bytes)});
  }
  for (const CommandInfo& info : kCommands) {
    EXPECT_TRUE(seen.contains({info.opcode, ParseOutcome::command})) << info.key;
    // Any number is allowed for these.
    const bool any = info.argument_count == 0 || info.opcode == 151 ||
                     (info.opcode >= 155 && info.opcode <= 157);
    if (any || info.opcode == 149) continue;
    EXPECT_TRUE(seen.contains({info.opcode, ParseOutcome::out_of_range})) << info.key;
  }
}

TEST(ParseCommand, IsSafeForRandomBytes) {
  std::mt19937 random{2};
  for (int i = 0; i < 200000; ++i) {
    Bytes bytes(random() % 40);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>(120 + random() % 48);
    (void)check(bytes);
  }
}

TEST(ParseCommand, SaysHowManyBytesATruncatedCommandNeeds) {
  for (const Bytes& whole :
       {Bytes{137, 255, 56, 1, 244}, Bytes{149, 2, 9, 13}, Bytes{139, 8, 0, 128},
        Bytes{140, 0, 2, 60, 32, 64, 32}, Bytes{152, 3, 155, 10, 153}}) {
    const CommandInfo& info = *kCreate.find_command(whole[0]);
    for (std::size_t size = 1; size < whole.size(); ++size) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const ParseResult result = parse_command(part);
      ASSERT_EQ(result.outcome, ParseOutcome::incomplete);
      const std::size_t fixed = 1 + info.argument_bytes();
      EXPECT_EQ(result.needed, (size < fixed ? fixed : whole.size()) - size);
      EXPECT_EQ(check(part), ParseOutcome::incomplete);
    }
    EXPECT_EQ(check(whole), ParseOutcome::command);
  }
  EXPECT_EQ(parse_command({}).outcome, ParseOutcome::incomplete);
  EXPECT_EQ(parse_command({}).needed, 1U);
}

TEST(ParseCommand, LeavesWhatFollowsAlone) {
  const ParseResult result = parse_command(Bytes{129, 10, 131});
  EXPECT_EQ(result.outcome, ParseOutcome::command);
  EXPECT_EQ(result.length, 2U);
}

TEST(ParseCommand, NamesTheArgumentThatIsOutOfRange) {
  const ParseResult drive = parse_command(Bytes{137, 0, 0, 8, 0});
  ASSERT_EQ(drive.outcome, ParseOutcome::out_of_range);
  EXPECT_EQ(drive.error.argument->name, "radius");
  EXPECT_EQ(drive.error.offset, 3U);
  EXPECT_EQ(drive.error.value, 2048);
  EXPECT_EQ(drive.length, 5U);

  const ParseResult stream = parse_command(Bytes{148, 3, 7, 43, 8});
  ASSERT_EQ(stream.outcome, ParseOutcome::out_of_range);
  EXPECT_EQ(stream.error.argument->name, "packet");
  EXPECT_EQ(stream.error.offset, 3U);

  Bytes song{140, 0, 17};
  song.resize(3 + 34);
  const ParseResult too_long = parse_command(song);
  ASSERT_EQ(too_long.outcome, ParseOutcome::out_of_range);
  EXPECT_EQ(too_long.error.argument->name, "length");
}

TEST(Parse, WantsExactlyTheCommandItIsAskedFor) {
  EXPECT_EQ(parse<Drive>(Bytes{145, 0, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(parse<Drive>(Bytes{137, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(parse<Drive>(Bytes{137, 0, 0, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(parse<Drive>(Bytes{137, 8, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(parse<Drive>({}), std::nullopt);
  EXPECT_EQ(parse<Stream>(Bytes{148}), std::nullopt);
  EXPECT_EQ(parse<Stream>(Bytes{148, 2, 7}), std::nullopt);
}

}  // namespace
}  // namespace cargobay::oi
