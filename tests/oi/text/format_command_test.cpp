#include <memory>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "oi/commands.hpp"
#include "oi/parse.hpp"
#include "oi/text/command_text.hpp"
#include "tests/oi/text/encoded.hpp"

namespace cargobay::oi {
namespace {

TEST(FormatCommand, RoundTripsEveryShortCommand) {
  std::set<std::string> texts;
  std::size_t commands = 0;
  for (const CommandInfo& info : kCommands) {
    if (info.tail != Tail::none || info.argument_bytes() > 2) continue;
    const std::size_t arguments = info.argument_bytes();
    for (unsigned value = 0; value < (arguments == 2   ? 65536U
                                      : arguments == 1 ? 256U
                                                       : 1U);
         ++value) {
      Bytes bytes{info.opcode};
      if (arguments == 2) bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
      if (arguments >= 1) bytes.push_back(static_cast<std::uint8_t>(value));
      if (parse_command(bytes).outcome != ParseResult::Outcome::command) {
        EXPECT_EQ(text_of(bytes), "");
        continue;
      }
      ++commands;
      texts.insert(round_trip(bytes));
    }
  }
  EXPECT_EQ(texts.size(), commands) << "one spelling for each";
}

TEST(FormatCommand, RoundTripsEverySpeedAndRadius) {
  for (int speed = -500; speed <= 500; ++speed) {
    const auto [high, low] =
        std::pair{static_cast<std::uint8_t>(static_cast<unsigned>(speed) >> 8U),
                  static_cast<std::uint8_t>(speed)};
    (void)round_trip({137, high, low, 128, 0});
    EXPECT_EQ(round_trip({145, 0, 7, high, low}), "drive_direct " + std::to_string(speed) + " 7");
  }
  for (int radius = -2000; radius <= 2000; ++radius) {
    (void)round_trip({137, 0, 1, static_cast<std::uint8_t>(static_cast<unsigned>(radius) >> 8U),
                      static_cast<std::uint8_t>(radius)});
  }
}

// A command of this kind with values in range, of any length.
Bytes random_command(const CommandInfo& info, std::mt19937& random) {
  for (;;) {
    Bytes bytes{info.opcode};
    for (const ArgumentInfo& argument : info.arguments()) {
      const auto range = static_cast<unsigned>(argument.max - argument.min + 1);
      const auto value =
          static_cast<unsigned>(argument.min) + static_cast<unsigned>(random()) % range;
      if (argument.size == 2) bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
      bytes.push_back(static_cast<std::uint8_t>(value));
    }
    if (info.tail != Tail::none) {
      const std::size_t count = bytes.back() * element_size(info.tail);
      const bool any = info.tail == Tail::notes || random() % 2 == 0;
      for (std::size_t i = 0; i < count; ++i) {
        const unsigned byte = info.tail == Tail::packet_ids ? static_cast<unsigned>(random()) % 43
                              : any ? static_cast<unsigned>(random())
                                    : 125U + static_cast<unsigned>(random()) % 34;
        bytes.push_back(static_cast<std::uint8_t>(byte));
      }
    }
    if (parse_command(bytes).outcome == ParseResult::Outcome::command) return bytes;
  }
}

TEST(FormatCommand, RoundTripsRandomLongCommands) {
  std::mt19937 random{3};
  for (const CommandInfo& info : kCommands) {
    for (int i = 0; i < 2000; ++i) (void)round_trip(random_command(info, random));
  }
}

TEST(FormatCommand, RoundTripsScriptsOfWholeCommands) {
  std::mt19937 random{4};
  for (int i = 0; i < 5000; ++i) {
    Bytes body;
    for (;;) {
      const CommandInfo& info = kCommands[random() % kCommandCount];
      if (info.tail == Tail::script_bytes) continue;
      const Bytes command = random_command(info, random);
      if (body.size() + command.size() > kMaxScriptBytes) break;
      body = body + command;
    }
    const std::string text = round_trip(Bytes{152, static_cast<std::uint8_t>(body.size())} + body);
    EXPECT_EQ(text.find("bytes"), std::string::npos) << text;
  }
}

TEST(FormatCommand, WritesWhatIsNoCommandInAScriptAsBytes) {
  EXPECT_EQ(round_trip({152, 2, 137, 1}), "script { bytes 137 1 }");
  EXPECT_EQ(round_trip({152, 4, 131, 7, 158, 5}), "script { safe; bytes 7; wait_event bump }");
  EXPECT_EQ(round_trip({152, 6, 137, 8, 0, 0, 0, 131}), "script { bytes 137 8 0 0 0; safe }");
  EXPECT_EQ(round_trip({152, 4, 152, 1, 131, 132}), "script { bytes 152 1 131; full }");
}

TEST(FormatCommand, RefusesWhatIsNotExactlyOneCommand) {
  EXPECT_EQ(text_of({}), "");
  EXPECT_EQ(text_of({7}), "");
  EXPECT_EQ(text_of({137, 0, 0, 0}), "");
  EXPECT_EQ(text_of({131, 131}), "");
  EXPECT_EQ(text_of({137, 8, 0, 0, 0}), "");
  EXPECT_EQ(text_of({148, 1, 43}), "");
}

TEST(FormatCommand, HasRoomForTheLongestAndRefusesLess) {
  Bytes longest{149, 255};
  longest.resize(257, 41);
  EXPECT_EQ(round_trip(longest).size(), kMaxCommandText);
  const Bytes drive{137, 255, 56, 1, 244};
  for (std::size_t room = 0; room <= 14; ++room) {
    const auto out = std::make_unique<char[]>(room);
    EXPECT_EQ(format_command(drive, {out.get(), room}), room < 14 ? 0U : 14U);
  }
}

}  // namespace
}  // namespace cargobay::oi
