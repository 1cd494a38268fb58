#include "oi/text/describe.hpp"

#include <array>
#include <memory>
#include <random>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/parse.hpp"
#include "tests/oi/feed.hpp"

namespace cargobay::oi {
namespace {

using Kind = Annotation::Kind;
using testing::HasSubstr;

// One line per annotation: `offset+count text`, with `! ` before an unsound one and two blanks
// before one inside a script.
class Collector {
 public:
  explicit Collector(std::size_t size) : size_{size} {}

  void take(const Annotation& annotation, const std::uint8_t* data) {
    lines_ << annotation.offset << '+' << annotation.bytes.size() << ' '
           << (annotation.in_script ? "  " : "") << (annotation.sound ? "" : "! ")
           << annotation.text << '\n';
    EXPECT_EQ(annotation.bytes.data(), data + annotation.offset);
    if (!annotation.sound) ++unsound_;
    if (annotation.kind == Kind::command || annotation.kind == Kind::missing) return;
    EXPECT_EQ(annotation.offset, at_) << "every byte once, in order";
    at_ = annotation.offset + annotation.bytes.size();
  }
  std::string finish(const Described& described) {
    EXPECT_EQ(described.unsound, unsound_);
    EXPECT_EQ(at_, size_);
    return lines_.str();
  }

 private:
  std::size_t size_;
  std::ostringstream lines_{};
  std::size_t at_ = 0;
  std::size_t unsound_ = 0;
};

struct Text {
  std::string lines;
  Described described;
};

template <typename Describe>
Text collected(const Bytes& bytes, Describe&& describe) {
  // Allocated to exactly its size, so that a sanitizer sees a read past the end.
  const auto exact = std::make_unique<std::uint8_t[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), exact.get());
  Collector collector{bytes.size()};
  const auto tell = [&](const Annotation& annotation) { collector.take(annotation, exact.get()); };
  const Described described = describe(std::span{exact.get(), bytes.size()}, tell);
  return {collector.finish(described), described};
}
Text commands(const Bytes& bytes) {
  return collected(bytes,
                   [](auto data, const auto& tell) { return describe_commands(data, tell); });
}
Text stream(const Bytes& bytes) {
  return collected(bytes, [](auto data, const auto& tell) { return describe_stream(data, tell); });
}
Text extended_commands(const Bytes& bytes) {
  return collected(bytes, [](auto data, const auto& tell) {
    return describe_commands(data, tell, kCreateWithExtensions);
  });
}
Text extended_stream(const Bytes& bytes) {
  return collected(bytes, [](auto data, const auto& tell) {
    return describe_stream(data, tell, kCreateWithExtensions);
  });
}
Text reply(const std::vector<PacketId>& packets, const Bytes& bytes) {
  return collected(
      bytes, [&](auto data, const auto& tell) { return describe_reply(packets, data, tell); });
}

TEST(DescribeCommands, SaysWhatEachByteMeans) {
  EXPECT_EQ(commands({137, 255, 56, 1, 244, 131}).lines,
            "0+1 Drive (OI p. 9)\n"
            "1+2 velocity -200 mm/s\n"
            "3+2 radius 500 mm\n"
            "0+5 drive -200 500\n"
            "5+1 Safe (OI p. 7)\n"
            "5+1 safe\n");
  EXPECT_EQ(commands({144, 32, 0, 128}).lines,
            "0+1 PWM Low Side Drivers (OI p. 10)\n"
            "1+1 driver_2 32\n"
            "2+1 driver_1 0\n"
            "3+1 driver_0 128\n"
            "0+4 pwm_low_side_drivers 128 0 32\n");
}

TEST(DescribeCommands, NamesValues) {
  EXPECT_THAT(commands({137, 0, 200, 128, 0}).lines, HasSubstr("3+2 radius -32768 straight\n"));
  EXPECT_THAT(commands({139, 8, 0, 128}).lines, HasSubstr("1+1 leds 8 advance\n"));
  EXPECT_THAT(commands({138, 0}).lines, HasSubstr("1+1 drivers 0 none\n"));
  EXPECT_THAT(commands({158, 251}).lines, HasSubstr("1+1 event -5 no_bump\n"));
  EXPECT_THAT(commands({129, 10}).lines, HasSubstr("1+1 code 10: 57600 baud\n"));
  EXPECT_THAT(commands({155, 15}).lines, HasSubstr("1+1 time 15 s/10 (1.5 s)\n"));
  EXPECT_THAT(commands({148, 2, 29, 13}).lines,
              HasSubstr("1+1 count 2\n2+1 packet 29 cliff_front_left_signal\n3+1 packet 13 "
                        "virtual_wall\n"));
  EXPECT_THAT(commands({140, 0, 2, 60, 32, 30, 255}).lines,
              HasSubstr("3+1 note 60\n4+1 duration 32 s/64 (0.5 s)\n5+1 note 30 rest\n6+1 duration "
                        "255 s/64 (3.984 s)\n"));
}

TEST(DescribeCommands, NamesOpcodesOfOtherRobots) {
  EXPECT_EQ(commands({173}).lines,
            "0+1 ! 173 is not a command of this robot, which ignores it; the Create 2 and Roombas "
            "have it: Stop\n");
  EXPECT_THAT(commands({133}).lines, HasSubstr("have it: Power"));
  EXPECT_THAT(commands({200}).lines, HasSubstr("200 is not a command; the robot ignores it"));
  EXPECT_THAT(commands({142, 45}).lines,
              HasSubstr("! packet 45: out of range; 0 to 42, or a name such as charging_state. "
                        "The Create 2 has it: Light Bumper\n"));
}

TEST(DescribeCommands, KnowsExtensionsIfAsked) {
  EXPECT_EQ(commands({7}).lines,
            "0+1 ! 7 is not a command of the manual, only of some robots: restarts the robot\n");
  EXPECT_EQ(extended_commands({7, 8}).lines,
            "0+1 Soft Reset, not in the manual: restarts the robot\n"
            "1+1 Firmware Date, not in the manual: asks for the date of the firmware\n");
  const Text query = extended_commands({149, 2, 43, 44});
  EXPECT_THAT(query.lines, HasSubstr("2+1 packet 43 raw_left_count\n"));
  EXPECT_EQ(query.described.unsound, 0U);
  EXPECT_EQ(extended_commands({142, 45}).described.unsound, 1U);
}

TEST(DescribeCommands, LooksIntoScripts) {
  EXPECT_EQ(commands({152, 5, 158, 5, 158, 251, 153}).lines,
            "0+1 Script (OI p. 15)\n"
            "1+1 length 5\n"
            "2+1   Wait Event (OI p. 16)\n"
            "3+1   event 5 bump\n"
            "4+1   Wait Event (OI p. 16)\n"
            "5+1   event -5 no_bump\n"
            "6+1   Play Script (OI p. 15)\n"
            "0+7 script { wait_event bump; wait_event no_bump; play_script }\n");
  EXPECT_THAT(commands({152, 2, 137, 1}).lines,
              HasSubstr("3+1   velocity\n4+0   ! the script ends inside this command\n"));
  EXPECT_THAT(commands({152, 3, 152, 1, 131}).lines, HasSubstr("4+1   of the script inside\n"));
  EXPECT_THAT(commands({152, 2, 152, 0}).lines, HasSubstr("! Script (OI p. 15): a script cannot"));
}

TEST(DescribeCommands, MarksWhatTheManualDoesNotHave) {
  EXPECT_EQ(commands({9, 131}).lines,
            "0+1 ! 9 is not a command; the robot ignores it\n1+1 Safe (OI p. 7)\n1+1 safe\n");
  const Text drive = commands({137, 2, 88, 0, 0, 131});
  EXPECT_EQ(drive.lines,
            "0+1 Drive (OI p. 9)\n"
            "1+2 ! velocity 600 mm/s: out of range; -500 to 500 mm/s\n"
            "3+2 radius 0 mm\n"
            "5+1 Safe (OI p. 7)\n"
            "5+1 safe\n");
  EXPECT_EQ(drive.described.unsound, 1U);
  EXPECT_EQ(drive.described.needed, 0U);
}

TEST(DescribeCommands, SaysHowManyBytesAreMissing) {
  const Text drive = commands({137, 255});
  EXPECT_EQ(drive.lines, "0+1 Drive (OI p. 9)\n1+1 velocity\n2+0 ! needs 3 more bytes\n");
  EXPECT_EQ(drive.described.needed, 3U);
  EXPECT_THAT(commands({148, 2, 29}).lines, HasSubstr("3+0 ! needs 1 more byte\n"));
  EXPECT_EQ(commands({140, 1}).described.needed, 1U);
  EXPECT_EQ(commands({152, 17, 131, 137, 0}).described.needed, 14U);
  EXPECT_EQ(commands({}).lines, "");
}

TEST(DescribeCommands, CoversAnyBytes) {
  std::mt19937 random{6};
  for (int i = 0; i < 30000; ++i) {
    Bytes bytes(random() % 60);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>(random() % 3 == 0 ? random() % 10 : 125 + random() % 36);
    (void)commands(bytes);
  }
}

TEST(DescribeCommands, AnswersForAllOpcodes) {
  for (unsigned opcode = 0; opcode < 256; ++opcode) {
    const auto byte = static_cast<std::uint8_t>(opcode);
    const CommandInfo* info = kCreate.find_command(byte);
    const std::string lines = commands({byte}).lines;
    EXPECT_THAT(lines, HasSubstr(info == nullptr ? "is not a command" : std::string{info->name}));
  }
}

TEST(DescribeStream, SaysWhatEachByteMeans) {
  EXPECT_EQ(stream({19, 5, 29, 2, 25, 13, 0, 182}).lines,
            "0+1 header of a stream frame (OI p. 14)\n"
            "1+1 5 bytes up to the checksum\n"
            "2+1 packet 29 Cliff Front Left Signal\n"
            "3+2 cliff_front_left_signal 537\n"
            "5+1 packet 13 Virtual Wall\n"
            "6+1 virtual_wall 0\n"
            "7+1 checksum, right without the header, as the manual has it\n");
  EXPECT_THAT(stream({19, 5, 29, 2, 25, 13, 0, 163}).lines,
              HasSubstr("7+1 checksum, right with the header counted, as robots send it\n"));
}

TEST(DescribeStream, SaysWhatTheChecksumShouldBe) {
  const Text text = stream({19, 5, 29, 2, 25, 13, 0, 0});
  EXPECT_THAT(
      text.lines,
      HasSubstr("7+1 ! wrong checksum: a3 would be right with the header counted, b6 without\n"));
  EXPECT_EQ(text.described.unsound, 1U);
}

TEST(DescribeStream, OpensGroups) {
  Bytes items{1};
  items.resize(11, 0);
  items[8] = 0b10010;
  const std::string lines = stream(frame_around(items)).lines;
  EXPECT_THAT(lines, HasSubstr("2+1 packet 1 Group 1\n3+1 bumps_and_wheel_drops 0 (none)\n"));
  EXPECT_THAT(lines, HasSubstr("10+1 overcurrents 18 ("));
}

TEST(DescribeStream, TellsTextFromDamage) {
  const Bytes good = frame_around({35, 2});
  const Text all = stream(text("bat: 1\r\nkey-wakeup\r\n") + Bytes{1, 2, 3} + good + Bytes{200});
  EXPECT_EQ(all.lines,
            "0+8 text 'bat: 1\\r\\n'\n"
            "8+12 text 'key-wakeup\\r\\n'\n"
            "20+3 ! outside any frame\n"
            "23+1 header of a stream frame (OI p. 14)\n"
            "24+1 2 bytes up to the checksum\n"
            "25+1 packet 35 OI Mode\n"
            "26+1 oi_mode 2 (safe)\n"
            "27+1 checksum, right with the header counted, as robots send it\n"
            "28+1 ! outside any frame\n");
}

TEST(DescribeStream, FindsTheFrameInsideWhatLooksLikeOne) {
  const Bytes good = frame_around({35, 2});
  // A header and a length that would swallow the frame, if its checksum were not right.
  const std::string lines = stream(Bytes{19, 5, 17, 0, 17} + good).lines;
  EXPECT_THAT(lines, HasSubstr("+1 oi_mode 2 (safe)\n"));
}

TEST(DescribeStream, SaysHowManyBytesAreMissing) {
  const Bytes whole{19, 5, 29, 2, 25, 13, 0, 182};
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const Text part = stream({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_EQ(part.described.needed, size == 1 ? 4U : whole.size() - size);
    EXPECT_EQ(part.described.unsound, 1U);
  }
  EXPECT_THAT(stream({19, 5, 29, 2}).lines,
              HasSubstr("3+1 cliff_front_left_signal\n4+0 ! needs 4 more bytes\n"));
}

TEST(DescribeStream, MarksNoValueThatARobotSends) {
  const Text text = stream(frame_around({35, 9}));
  EXPECT_THAT(text.lines, HasSubstr("oi_mode 9 (unknown), outside the manual's 0 to 3\n"));
  EXPECT_EQ(text.described.unsound, 0U);
}

TEST(DescribeStream, NamesAFrameOfTheCreate2) {
  const Text text = stream(frame_around({43, 1, 2, 35, 2, 45, 7}));
  EXPECT_EQ(text.lines,
            "0+1 header of a stream frame (OI p. 14)\n"
            "1+1 7 bytes up to the checksum\n"
            "2+1 ! packet 43 Left Encoder Counts of the Create 2 or a Roomba; this robot has none\n"
            "3+2 258\n"
            "5+1 packet 35 OI Mode\n"
            "6+1 oi_mode 2 (safe)\n"
            "7+1 ! packet 45 Light Bumper of the Create 2 or a Roomba; this robot has none\n"
            "8+1 7\n"
            "9+1 checksum, right with the header counted, as robots send it\n");
  EXPECT_THAT(stream(Bytes{1, 2} + frame_around({58, 1})).lines, HasSubstr("packet 58 Stasis"));
  EXPECT_THAT(stream(frame_around(Bytes{107} + Bytes(9, 0))).lines,
              HasSubstr("3+9 9 bytes of data\n"));
}

TEST(DescribeStream, NamesAFrameOfTheCreate2ThatIsCutShort) {
  const Bytes whole = frame_around({7, 0, 43, 1, 2, 45, 7});
  EXPECT_EQ(stream(Bytes(whole.begin(), whole.begin() + 6)).lines,
            "0+1 header of a stream frame (OI p. 14)\n"
            "1+1 7 bytes up to the checksum\n"
            "2+1 packet 7 Bumps and Wheel Drops\n"
            "3+1 bumps_and_wheel_drops 0 (none)\n"
            "4+1 ! packet 43 Left Encoder Counts of the Create 2 or a Roomba; this robot has none\n"
            "5+1 part of its data\n"
            "6+0 ! needs 4 more bytes\n");
  for (std::size_t size = 5; size < whole.size(); ++size) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THAT(stream(part).lines, HasSubstr("Left Encoder Counts of the Create 2")) << size;
    EXPECT_THAT(stream(whole + part).lines, HasSubstr("needs ")) << size;
    EXPECT_THAT(stream(Bytes{1} + part).lines, Not(HasSubstr("Create 2"))) << size;
  }
}
TEST(DescribeStream, NamesADamagedFrameOfTheCreate2WhereAFrameBegins) {
  Bytes damaged = frame_around({43, 1, 2});
  damaged.back() ^= 1U;
  EXPECT_THAT(stream(damaged).lines, HasSubstr("Left Encoder Counts of the Create 2"));
  EXPECT_THAT(stream(damaged).lines, HasSubstr("! wrong checksum"));
  EXPECT_THAT(stream(Bytes{1} + damaged).lines, Not(HasSubstr("Create 2")));
}

TEST(DescribeStream, NamesAFrameOfAnUnknownRobotWhereAFrameBegins) {
  const Bytes unknown = frame_around({35, 2, 90, 1, 2, 3});
  const std::string expected =
      "4+1 ! packet 90 of neither this robot nor the Create 2: where it ends is not known\n"
      "5+3 3 bytes of data\n";
  EXPECT_THAT(stream(unknown).lines, HasSubstr(expected));
  EXPECT_THAT(stream(Bytes{1} + unknown).lines, Not(HasSubstr("packet 90")));
  EXPECT_THAT(stream(frame_around({35, 2, 90})).lines, HasSubstr("packet 90 of neither"));
  Bytes damaged = unknown;
  damaged.back() ^= 1U;
  EXPECT_THAT(stream(damaged).lines, Not(HasSubstr("packet 90")));
}

TEST(DescribeStream, KnowsExtensionsIfAsked) {
  const Text frame = extended_stream(frame_around({43, 1, 2}));
  EXPECT_THAT(frame.lines, HasSubstr("3+2 raw_left_count 258\n"));
  EXPECT_EQ(frame.described.unsound, 0U);
  const auto date = firmware_date_answer({7, 9, 24, 18, 5});
  const Bytes answer{date.begin(), date.end()};
  EXPECT_EQ(extended_stream(answer).lines,
            "0+7 answer to opcode 8: firmware of 2007-09-24 18:05\n");
  EXPECT_THAT(stream(answer).lines, Not(HasSubstr("firmware")));
}

TEST(DescribeStream, CoversAnyBytes) {
  std::mt19937 random{7};
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(random() % 80);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>(random() % 4 == 0 ? 19 : random() % 45);
    (void)stream(bytes);
    (void)extended_stream(bytes);
    (void)extended_commands(bytes);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    (void)stream(bytes);
  }
}

TEST(DescribeReply, DividesTheReplyByTheRequest) {
  EXPECT_EQ(reply({PacketId::distance, PacketId::bumps_and_wheel_drops}, {255, 254, 3}).lines,
            "0+2 distance -2 mm\n2+1 bumps_and_wheel_drops 3 (bump_right, bump_left)\n");
  const Text part = reply({PacketId::group_2}, {255, 1, 0});
  EXPECT_EQ(part.lines,
            "0+1 infrared_byte 255 (none)\n1+1 buttons 1 (play)\n2+1 distance\n"
            "3+0 ! needs 3 more bytes\n");
  EXPECT_EQ(reply({PacketId::wall}, {1, 2}).lines, "0+1 wall 1\n1+1 ! more than the reply\n");
  EXPECT_EQ(reply({}, {}).lines, "");
}

TEST(DescribeReply, NamesEveryPacketAndItsUnit) {
  for (const PacketInfo& info : kPackets) {
    const std::string lines = reply({static_cast<PacketId>(info.id)}, Bytes(info.size, 0)).lines;
    for (std::uint8_t id = info.first; id <= info.last; ++id) {
      const PacketInfo& single = kPackets[id];
      EXPECT_THAT(lines, HasSubstr(std::string{single.key} + " 0"));
      if (single.unit != Unit::none) {
        EXPECT_THAT(lines, HasSubstr(std::string{single.key} + " 0 " +
                                     std::string{symbol(single.unit)} + "\n"));
      }
    }
  }
}

}  // namespace
}  // namespace cargobay::oi
