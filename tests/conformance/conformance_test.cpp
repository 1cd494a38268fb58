// What any Create does, by the sections of its manual, asked only over its serial line, so that any
// other device can be asked the same.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"
#include "tests/conformance/subject.hpp"

namespace cargobay::conformance {
namespace {

// One for each section, in the order of the manual.
using GettingStartedCommands = Conformance;
using ModeCommands = Conformance;
using DemoCommands = Conformance;
using ActuatorCommands = Conformance;
using SongCommands = Conformance;
using InputCommands = Conformance;
using ScriptCommands = Conformance;
using WaitCommands = Conformance;

// --- Getting Started (OI p. 7) ---

TEST_F(GettingStartedCommands, StartMakesItPassive) {
  send({132});
  EXPECT_EQ(mode(), 3);
  send({128});
  EXPECT_EQ(mode(), 1);
}

TEST_F(GettingStartedCommands, BaudChangesTheRateBothWays) {
  send({129, 7});
  wait(150ms);
  ASSERT_FALSE(stream().set_baud(19200));
  EXPECT_EQ(mode(), 1);
  send({129, *oi::kCreate.baud_code(boot_baud)});
  wait(150ms);
  ASSERT_FALSE(stream().set_baud(boot_baud));
  EXPECT_EQ(mode(), 1);
}

TEST_F(GettingStartedCommands, EveryBaudCodeIsItsRate) {
  constexpr std::array<std::uint32_t, 12> kRates{300,   600,   1200,  2400,  4800,  9600,
                                                 14400, 19200, 28800, 38400, 57600, 115200};
  std::uint8_t code = 0;
  for (const std::uint32_t rate : kRates) {
    send({129, code++});
    wait(150ms);
    ASSERT_FALSE(stream().set_baud(rate));
    EXPECT_EQ(mode(), 1) << rate << " baud";
    wait(1ms);  // 115200 needs a pause after the answer too
  }
  send({129, *oi::kCreate.baud_code(boot_baud)});
  wait(150ms);
  ASSERT_FALSE(stream().set_baud(boot_baud));
  EXPECT_EQ(mode(), 1);
}

TEST_F(GettingStartedCommands, AnUnknownBaudCodeChangesNothing) {
  send({129, 12});
  wait(150ms);
  EXPECT_EQ(mode(), 1);
}

TEST_F(GettingStartedCommands, AHalfSentCommandWaitsForItsBytes) {
  send({132, 145, 0});
  wait(1s);
  send({128});
  EXPECT_TRUE(listen(50ms).empty());
  send({0, 0});  // the right wheel at 128 mm/s, the left at 0
  EXPECT_EQ(word_packet(41), 128);
  EXPECT_EQ(mode(), 3) << "128 was data";
}

TEST_F(GettingStartedCommands, UnknownOpcodesAreIgnored) {
  for (const std::uint8_t opcode : Bytes{0, 1, 127, 133, 146, 159, 173, 254, 255}) {
    send({opcode});
    EXPECT_EQ(mode(), 1) << int{opcode};
  }
}

// --- Mode (OI p. 6, 7) ---

TEST_F(ModeCommands, ReachEveryModeFromEveryOther) {
  for (const auto& [from, to, number] :
       {std::tuple{131, 132, 3}, std::tuple{132, 131, 2}, std::tuple{131, 128, 1},
        std::tuple{132, 130, 2}, std::tuple{128, 132, 3}}) {
    send({static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(to)});
    EXPECT_EQ(mode(), number) << from << " then " << to;
  }
}

TEST_F(ModeCommands, EachIsTakenInEachMode) {
  for (const std::uint8_t from : Bytes{128, 131, 132}) {
    for (const auto& [to, number] : {std::pair{128, 1}, {130, 2}, {131, 2}, {132, 3}}) {
      send({from, static_cast<std::uint8_t>(to)});
      EXPECT_EQ(mode(), number) << int{from} << " then " << to;
    }
  }
}

// All except the actuators' commands; each leaves the mode as it is.
TEST_F(ModeCommands, OthersAreObeyedInEachMode) {
  for (const auto& [opcode, number] : {std::pair{128, 1}, {131, 2}, {132, 3}}) {
    const auto its_own = static_cast<std::uint8_t>(number);
    const auto mode_is_kept_by = [&](const char* command) {
      EXPECT_EQ(mode(), its_own) << command << " in mode " << int{its_own};
    };
    send({static_cast<std::uint8_t>(opcode)});
    EXPECT_EQ(ask({142, 35}, 1), (Bytes{its_own})) << "Sensors";
    EXPECT_EQ(ask({149, 2, 35, 35}, 2), (Bytes{its_own, its_own})) << "Query List";
    EXPECT_EQ(ask({148, 1, 35}, 5).size(), 5U) << "Stream in mode " << int{its_own};
    send({150, 0});
    wait(100ms);
    EXPECT_TRUE(listen(50ms).empty()) << "Pause Stream in mode " << int{its_own};
    mode_is_kept_by("Pause Stream");
    EXPECT_EQ(ask({150, 1}, 5).size(), 5U) << "Resume Stream in mode " << int{its_own};
    send({148, 0});
    wait(100ms);
    mode_is_kept_by("Stream");
    send({140, 7, 1, 30, 1});
    mode_is_kept_by("Song");
    send({152, 2, 142, 35});
    mode_is_kept_by("Script");
    EXPECT_EQ(ask({154}, 3), (Bytes{2, 142, 35})) << "Show Script in mode " << int{its_own};
    EXPECT_EQ(ask({153}, 1), (Bytes{its_own})) << "Play Script";
    EXPECT_EQ(ask({155, 1, 142, 35}, 1), (Bytes{its_own})) << "Wait Time";
    EXPECT_EQ(ask({158, 251, 142, 35}, 1), (Bytes{its_own})) << "Wait Event";
    send({129, *oi::kCreate.baud_code(boot_baud)});
    wait(150ms);
    mode_is_kept_by("Baud");
  }
}

TEST_F(ModeCommands, WaitsForMotionAreObeyedInEachMode) {
  for (const auto& [opcode, number] : {std::pair{128, 1}, {131, 2}, {132, 3}}) {
    const auto its_own = static_cast<std::uint8_t>(number);
    send({static_cast<std::uint8_t>(opcode)});
    EXPECT_EQ(ask({156, 0, 0, 142, 35}, 1), (Bytes{its_own})) << "Wait Distance";
    EXPECT_EQ(ask({157, 0, 0, 142, 35}, 1), (Bytes{its_own})) << "Wait Angle";
  }
}

TEST_F(ModeCommands, SafeAndFullLeaveTheWheelsTurning) {
  send({131, 145, 0, 100, 0, 100, 132});
  wait(300ms);
  EXPECT_GT(moved_within(300ms), 10);
  send({131});
  EXPECT_GT(moved_within(300ms), 10);
}

TEST_F(ModeCommands, PassiveDoesNotDrive) {
  send({132, 145, 0, 0, 0, 0, 128});
  send({145, 0, 50, 0, 50});
  EXPECT_EQ(word_packet(41), 0);
  EXPECT_EQ(word_packet(42), 0);
}

TEST_F(ModeCommands, PassiveTakesSongsAndScriptsForLater) {
  send({140, 6, 1, 60, 16, 152, 1, 128, 132, 141, 6});
  EXPECT_EQ(packet(36), 6);
  EXPECT_EQ(packet(37), 1);
  EXPECT_EQ(ask({154}, 2), (Bytes{1, 128}));
  wait(300ms);
}

TEST_F(ModeCommands, PassiveStopsWhatTurns) {
  send({132, 145, 0, 100, 0, 100});
  wait(300ms);
  send({128});
  wait(700ms);
  EXPECT_LE(moved_within(300ms), 1);
}

TEST_F(ModeCommands, PassivePlaysNoSong) {
  send({140, 0, 1, 60, 64, 141, 0});
  EXPECT_EQ(packet(37), 0);
}

// --- Demos (OI p. 8) ---

TEST_F(DemoCommands, MakeItPassive) {
  for (const std::uint8_t opcode : Bytes{134, 135, 143}) {
    send({132, opcode});
    EXPECT_EQ(mode(), 1) << int{opcode};
    send({136, 255});
  }
  send({132, 136, 255});
  EXPECT_EQ(mode(), 1);
}

TEST_F(DemoCommands, AreTakenInEachMode) {
  for (const std::uint8_t from : Bytes{128, 131, 132}) {
    for (const Bytes& demo : {Bytes{134}, Bytes{135}, Bytes{143}, Bytes{136, 4}}) {
      (void)moved_within(0ms);
      send({from});
      send(demo);
      wait(600ms);
      EXPECT_EQ(mode(), 1) << int{demo[0]};
      EXPECT_GT(std::abs(word_packet(19)), 5) << int{from} << " then " << int{demo[0]};
      send({136, 255});
      wait(500ms);
    }
  }
}

TEST_F(DemoCommands, HaveTenNumbers) {
  for (std::uint8_t number = 0; number < 10; ++number) {
    send({132, 136, number});
    EXPECT_EQ(mode(), 1) << int{number};
    send({136, 255});
  }
}

TEST_F(DemoCommands, ANumberThatIsNoneStopsAndMakesItPassive) {
  send({132, 145, 0, 100, 0, 100});
  wait(300ms);
  send({136, 10});
  EXPECT_EQ(mode(), 1);
  wait(700ms);
  EXPECT_LE(moved_within(300ms), 1);
}

TEST_F(DemoCommands, CoverDrivesUntilItIsAborted) {
  (void)moved_within(0ms);
  send({135});
  EXPECT_GT(moved_within(1500ms), 50);
  send({136, 255});
  wait(700ms);
  EXPECT_LE(moved_within(300ms), 1) << "it stands";
}

TEST_F(DemoCommands, AModeCommandTakesOver) {
  send({135});
  wait(500ms);
  send({132});
  wait(700ms);
  EXPECT_LE(moved_within(300ms), 1);
  EXPECT_EQ(mode(), 3);
}

// --- Actuators (OI p. 9 to 11) ---

TEST_F(ActuatorCommands, DriveIsReadBack) {
  send({132, 137, 0xff, 0xce, 1, 244});  // -50 mm/s, radius 500 mm
  EXPECT_EQ(word_packet(39), -50);
  EXPECT_EQ(word_packet(40), 500);
}

TEST_F(ActuatorCommands, SpeedsAndRadiiOutOfRangeAreBroughtIntoIt) {
  send({132, 137, 0, 0, 0x07, 0xd1});  // 2001 mm
  EXPECT_EQ(word_packet(40), 2000);
  send({145, 0x01, 0xf5, 0, 0, 142, 41, 145, 0, 0, 0, 0});  // 501 mm/s, for an instant
  EXPECT_EQ(receive(2), (Bytes{0x01, 0xf4}));
}

TEST_F(ActuatorCommands, DriveDirectIsReadBackRightAndLeft) {
  send({132, 145, 0, 40, 0xff, 0xd8});
  EXPECT_EQ(word_packet(41), 40);
  EXPECT_EQ(word_packet(42), -40);
}

TEST_F(ActuatorCommands, DrivingIsMeasured) {
  send({132, 142, 2});
  (void)receive(6);
  send({145, 0, 100, 0, 100});
  wait(1s);
  send({145, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  EXPECT_GT(distance, 60);
  EXPECT_LT(distance, 120);
  EXPECT_EQ(word_packet(19), 0) << "a reading clears";
}

TEST_F(ActuatorCommands, DriveGoesStraightByEitherOfTwoRadii) {
  for (const auto& [high, low] : {std::pair{0x80, 0x00}, std::pair{0x7f, 0xff}}) {
    send({132, 142, 2});
    (void)receive(6);
    send({137, 0, 100, static_cast<std::uint8_t>(high), static_cast<std::uint8_t>(low)});
    wait(1s);
    send({137, 0, 0, 0, 0});
    wait(500ms);
    EXPECT_GT(word_packet(19), 60);
    EXPECT_LE(std::abs(word_packet(20)), 5) << "a degree or two of droop";
  }
}

TEST_F(ActuatorCommands, DrivingBackwardIsNegative) {
  (void)moved_within(0ms);
  send({132, 145, 0xff, 0x9c, 0xff, 0x9c});
  const int moved = moved_within(1s);
  send({145, 0, 0, 0, 0});
  EXPECT_LT(moved, -60);
  EXPECT_GT(moved, -120);
  wait(500ms);
}

TEST_F(ActuatorCommands, DriveTurnsClockwiseByRadiusMinusOne) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 100, 0xff, 0xff});
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_LT(angle, -25);
  EXPECT_GT(angle, -60);
}

TEST_F(ActuatorCommands, DriveTurnsAroundACentreToTheLeft) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 150, 1, 44});  // 150 mm/s, radius 300 mm
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  const std::int16_t angle = word_packet(20);
  EXPECT_GT(distance, 100);
  EXPECT_GT(angle, 15);
  EXPECT_NEAR(angle, distance * 57.3 / 300.0, 8.0) << "an arc of that radius";
}

TEST_F(ActuatorCommands, TurningIsMeasuredCounterClockwisePositive) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 100, 0, 1});
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_GT(angle, 25);
  EXPECT_LT(angle, 60);
}

TEST_F(ActuatorCommands, DriveTurnsRightByANegativeRadius) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 150, 0xfe, 0xd4});  // 150 mm/s, radius -300 mm
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  const std::int16_t angle = word_packet(20);
  EXPECT_GT(distance, 100);
  EXPECT_NEAR(angle, distance * -57.3 / 300.0, 8.0);
}

TEST_F(ActuatorCommands, DriveTurnsLessByALongerRadius) {
  const auto turned = [this](std::uint8_t high, std::uint8_t low) {
    send({132, 142, 2});
    (void)receive(6);
    send({137, 0, 150, high, low});
    wait(1s);
    send({137, 0, 0, 0, 0});
    wait(500ms);
    return word_packet(20);
  };
  const std::int16_t short_radius = turned(0, 200);
  const std::int16_t middle = turned(1, 144);   // 400 mm
  const std::int16_t longest = turned(7, 208);  // 2000 mm
  EXPECT_GT(short_radius, middle);
  EXPECT_GT(middle, longest);
}

TEST_F(ActuatorCommands, DriveBacksByANegativeVelocity) {
  (void)moved_within(0ms);
  send({132, 137, 0xff, 0x9c, 128, 0});  // -100 mm/s
  const int moved = moved_within(1s);
  send({137, 0, 0, 0, 0});
  EXPECT_LT(moved, -60);
  EXPECT_GT(moved, -120);
  wait(500ms);
}

TEST_F(ActuatorCommands, DriveDirectMovesEachWheelByItself) {
  for (const auto& [command, forward, left] :
       {std::tuple{Bytes{145, 0, 150, 0, 0}, true, true},          // the right wheel forward
        std::tuple{Bytes{145, 0, 0, 0, 150}, true, false},         // the left wheel forward
        std::tuple{Bytes{145, 0xff, 0x6a, 0, 0}, false, false},    // the right wheel back
        std::tuple{Bytes{145, 0, 0, 0xff, 0x6a}, false, true}}) {  // the left wheel back
    send({132, 142, 2});
    (void)receive(6);
    send(command);
    wait(700ms);
    send({145, 0, 0, 0, 0});
    wait(500ms);
    EXPECT_EQ(word_packet(19) > 15, forward);
    EXPECT_EQ(word_packet(20) > 10, left);
  }
}

TEST_F(ActuatorCommands, AreObeyedInSafeAndKeepTheMode) {
  for (const auto& [opcode, number] : {std::pair{131, 2}, {132, 3}}) {
    send({static_cast<std::uint8_t>(opcode)});
    send({137, 0xff, 0xce, 1, 244});
    EXPECT_EQ(word_packet(39), -50);
    EXPECT_EQ(mode(), number) << "Drive";
    send({145, 0, 40, 0, 20});
    EXPECT_EQ(word_packet(41), 40);
    EXPECT_EQ(word_packet(42), 20);
    send({145, 0, 0, 0, 0});
    EXPECT_EQ(mode(), number) << "Drive Direct";
    send({140, 2, 1, 60, 8, 141, 2});
    EXPECT_EQ(packet(37), 1);
    EXPECT_EQ(mode(), number) << "Play Song";
    wait(300ms);
    for (const Bytes& command :
         {Bytes{139, 8, 0, 128}, Bytes{147, 5}, Bytes{144, 32, 0, 16}, Bytes{138, 2},
          Bytes{151, 77}, Bytes{138, 0}, Bytes{147, 0}, Bytes{139, 0, 0, 0}}) {
      send(command);
      EXPECT_EQ(mode(), number) << int{command[0]};
    }
  }
}

TEST_F(ActuatorCommands, TakeTheirBytesAndNoMore) {
  for (const Bytes& command :
       {Bytes{139, 8, 0, 128}, Bytes{138, 2}, Bytes{144, 32, 0, 128}, Bytes{147, 5}, Bytes{151, 77},
        Bytes{138, 0}, Bytes{147, 0}, Bytes{139, 0, 0, 0}}) {
    send({132});
    send(command);
    EXPECT_EQ(mode(), 3) << int{command[0]};
  }
}

// What they do shows only on the robot; that they leave the rest alone shows here, too.
TEST_F(ActuatorCommands, LedsOutputsDriversAndIrLeaveTheWheelsAndTheStreamAlone) {
  send({132, 145, 0, 0, 0, 30, 148, 1, 35});
  for (const Bytes& command :
       {Bytes{139, 10, 128, 255}, Bytes{147, 7}, Bytes{138, 7}, Bytes{144, 128, 64, 1},
        Bytes{151, 200}, Bytes{139, 0, 0, 0}, Bytes{147, 0}, Bytes{138, 0}, Bytes{144, 0, 0, 0}}) {
    send(command);
    const Bytes frames = receive(10);
    ASSERT_EQ(frames.size(), 10U) << int{command[0]};
    EXPECT_EQ(frames[3], 3) << int{command[0]};
  }
  send({150, 0});
  wait(100ms);
  EXPECT_EQ(word_packet(42), 30);
  EXPECT_EQ(packet(14), 0) << "no overcurrent";
}

// --- Songs (OI p. 11, 12) ---

TEST_F(SongCommands, OutlastTheirMode) {
  send({132, 140, 0, 1, 60, 32, 141, 0, 128});
  EXPECT_EQ(packet(37), 1);
  wait(700ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, PlayForAsLongAsTheirNotesSay) {
  send({132, 140, 3, 2, 60, 32, 30, 32});  // half a second, and a rest of the same length
  send({141, 3});
  EXPECT_EQ(packet(36), 3);
  EXPECT_EQ(packet(37), 1);
  wait(800ms);
  EXPECT_EQ(packet(37), 1);
  wait(400ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, PlayIsIgnoredWhileASongPlays) {
  send({132, 140, 1, 1, 60, 48, 140, 2, 1, 62, 48, 141, 1, 141, 2});
  EXPECT_EQ(packet(36), 1);
  wait(900ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, AreOverwritten) {
  send({132, 140, 4, 1, 60, 255, 140, 4, 1, 60, 8, 141, 4});
  wait(300ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, PlayOnWhenTheirNumberIsGivenAway) {
  send({132, 140, 5, 1, 60, 48, 141, 5, 140, 5, 1, 62, 4});
  wait(400ms);
  EXPECT_EQ(packet(37), 1) << "the new one would be over";
  wait(600ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, OfSeventeenNotesAreNotStored) {
  send({132, 140, 7, 1, 60, 8});
  Bytes longer{140, 7, 17};
  for (int i = 0; i < 17; ++i) longer.insert(longer.end(), {70, 32});
  send(longer);
  send({141, 7});
  wait(400ms);
  EXPECT_EQ(packet(37), 0) << "the one before was an eighth of a second";
}

TEST_F(SongCommands, HoldSixteenNotes) {
  Bytes song{132, 140, 15, 16};
  for (int i = 0; i < 16; ++i) song.insert(song.end(), {70, 4});
  send(song);
  send({141, 15});
  wait(800ms);
  EXPECT_EQ(packet(37), 1);
  wait(400ms);
  EXPECT_EQ(packet(37), 0);
}

// --- Input (OI p. 13, 14) ---

TEST_F(InputCommands, EveryPacketHasItsSize) {
  for (std::uint8_t id = 0; id < oi::kPacketCount; ++id) {
    send({142, id});
    EXPECT_EQ(listen(40ms).size(), oi::kCreate.packet_size(id)) << int{id};
  }
}

TEST_F(InputCommands, EveryPacketIsInItsRange) {
  for (std::uint8_t id = oi::kFirstSinglePacket; id < oi::kPacketCount; ++id) {
    const oi::PacketInfo& info = oi::kPackets[id];
    const Bytes data = ask({142, id}, info.size);
    ASSERT_EQ(data.size(), info.size) << int{id};
    std::int32_t value = data[0];
    if (info.size == 2) value = value * 256 + data[1];
    if (info.is_signed && info.size == 2 && value > 32767) value -= 65536;
    if (info.is_signed && info.size == 1 && value > 127) value -= 256;
    EXPECT_GE(value, info.min) << info.name;
    EXPECT_LE(value, info.max) << info.name;
  }
}

TEST_F(InputCommands, WhatIsNoPacketHasNoAnswer) {
  send({142, 100});
  EXPECT_TRUE(listen(50ms).empty());
  EXPECT_EQ(mode(), 1);
}

TEST_F(InputCommands, ChargingAgreesWithItsSources) {
  send({149, 2, 21, 34});
  const Bytes state = receive(2);
  ASSERT_EQ(state.size(), 2U);
  EXPECT_TRUE(state[1] != 0 || state[0] == 0) << "nothing charges out of nothing";
  send({132});
  EXPECT_EQ(packet(21), 0) << "Full does not charge";
}

TEST_F(InputCommands, ChargeIsAtMostTheCapacity) {
  const Bytes battery = ask({149, 2, 25, 26}, 4);
  ASSERT_EQ(battery.size(), 4U);
  EXPECT_LE(battery[0] * 256 + battery[1], battery[2] * 256 + battery[3]);
}

TEST_F(InputCommands, CliffsAgreeWithTheirSignals) {
  const Bytes seen = ask({149, 8, 9, 10, 11, 12, 28, 29, 30, 31}, 12);
  ASSERT_EQ(seen.size(), 12U);
  for (std::size_t i = 0; i < 4; ++i) {
    const int signal = seen[4 + 2 * i] * 256 + seen[5 + 2 * i];
    EXPECT_TRUE(seen[i] == 1 || signal > 0) << "a floor reflects";
  }
}

TEST_F(InputCommands, TheLongestGroupIsAllPackets) {
  Bytes list{149, 36};
  for (std::uint8_t id = 7; id <= 42; ++id) list.push_back(id);
  const Bytes group = ask({142, 6}, 52);
  const Bytes one_by_one = ask(list, 52);
  ASSERT_EQ(group.size(), 52U);
  ASSERT_EQ(one_by_one.size(), 52U);
  // Except what changes by itself: the battery's five, at 16 to 25 of the 52.
  const auto battery_from = [](const Bytes& bytes) { return bytes.begin() + 16; };
  EXPECT_TRUE(std::equal(group.begin(), battery_from(group), one_by_one.begin()));
  EXPECT_TRUE(std::equal(battery_from(group) + 10, group.end(), battery_from(one_by_one) + 10));
}

TEST_F(InputCommands, EachGroupIsItsPacketsInOrder) {
  wait(50ms);
  for (const auto& [group, first, last] : {std::tuple{0, 7, 26},
                                           {1, 7, 16},
                                           {2, 17, 20},
                                           {3, 21, 26},
                                           {4, 27, 34},
                                           {5, 35, 42},
                                           {6, 7, 42}}) {
    Bytes list{149, static_cast<std::uint8_t>(last - first + 1)};
    std::size_t size = 0;
    std::size_t battery = 0;
    for (int id = first; id <= last; ++id) {
      if (id == 22) battery = size;
      list.push_back(static_cast<std::uint8_t>(id));
      size += oi::kCreate.packet_size(static_cast<std::uint8_t>(id));
    }
    Bytes whole = ask({142, static_cast<std::uint8_t>(group)}, size);
    Bytes singly = ask(list, size);
    ASSERT_EQ(whole.size(), size) << group;
    ASSERT_EQ(singly.size(), size) << group;
    // Except what changes by itself: voltage, current, temperature and charge.
    for (Bytes* bytes : {&whole, &singly}) {
      if (first <= 22 && last >= 22) {
        std::fill_n(bytes->begin() + static_cast<std::ptrdiff_t>(battery), 7, std::uint8_t{0});
      }
    }
    EXPECT_EQ(whole, singly) << "group " << group;
    EXPECT_TRUE(listen(40ms).empty()) << "group " << group;
  }
}

TEST_F(InputCommands, QueryListTakes255Packets) {
  Bytes list{149, 255};
  list.resize(2 + 255, 35);
  EXPECT_EQ(ask(list, 255), Bytes(255, 1));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(InputCommands, StreamTakes43Packets) {
  Bytes list{148, 43};
  list.resize(2 + 43, 35);
  send(list);
  send({150, 0});
  wait(200ms);
  EXPECT_EQ(packet(38), 43);
  send({148, 0});
}

TEST_F(InputCommands, ChangeNoSoonerThanATick) {
  // Moving values are read as fast as the line allows: most readings are of the same tick.
  send({132, 145, 0, 100, 0, 100});
  wait(500ms);
  int readings = 0;
  int changes = 0;
  const rt::TimePoint before = stream().now();
  while (stream().now() - before < 600ms) {
    ++readings;
    if (word_packet(19) != 0) ++changes;
  }
  const auto ticks = (stream().now() - before) / 15ms;
  send({145, 0, 0, 0, 0});
  EXPECT_LE(changes, ticks + 1);
  if (readings < 2 * ticks) GTEST_SKIP() << "this line is too slow to tell";
  EXPECT_GT(changes, ticks / 2);
}

TEST_F(InputCommands, QueryListTakesGroups) {
  EXPECT_EQ(ask({149, 3, 0, 35, 6}, 26 + 1 + 52).size(), 79U);
  EXPECT_TRUE(listen(50ms).empty());
}

// At the rate of the line: 2.3 s at 57600.
TEST_F(InputCommands, TheLongestQueryListIsAnsweredWhole) {
  Bytes list{149, 255};
  list.resize(257, 6);
  send(list);
  EXPECT_EQ(receive(255 * std::size_t{52}, 20s).size(), 255U * 52U);
  EXPECT_TRUE(listen(50ms).empty());
  EXPECT_EQ(mode(), 1);
}

TEST_F(InputCommands, WhatIsNoPacketInAListIsPassedOver) {
  EXPECT_EQ(ask({149, 3, 35, 100, 37}, 2), (Bytes{1, 0}));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(InputCommands, GroupsAreTheirPacketsInOrder) {
  send({132, 145, 0, 0, 0, 0});
  wait(50ms);
  const Bytes group = ask({142, 5}, 12);
  const Bytes list = ask({149, 8, 35, 36, 37, 38, 39, 40, 41, 42}, 12);
  EXPECT_EQ(group, list);
}

TEST_F(InputCommands, QueryListAnswersInTheOrderAsked) {
  send({132});
  EXPECT_EQ(ask({149, 3, 35, 37, 35}, 3), (Bytes{3, 0, 3}));
  send({149, 0});
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(InputCommands, StreamSendsFramesThatAddUp) {
  send({148, 2, 29, 13});
  const Bytes frames = receive(80);
  send({150, 0});
  ASSERT_EQ(frames.size(), 80U);
  for (std::size_t at = 0; at < frames.size(); at += 8) {
    const std::span<const std::uint8_t> frame{frames.data() + at, 8};
    EXPECT_EQ(frame[0], 19);
    EXPECT_EQ(frame[1], 5);
    EXPECT_EQ(frame[2], 29);
    EXPECT_EQ(frame[5], 13);
    EXPECT_TRUE(oi::checksum_matches(frame, oi::Checksum::automatic));
  }
}

TEST_F(InputCommands, StreamSendsAFrameEachFifteenMilliseconds) {
  send({148, 1, 35});
  (void)receive(5);
  const rt::TimePoint before = stream().now();
  (void)receive(5 * 100, 5s);
  const rt::Duration period = (stream().now() - before) / 100;
  send({150, 0});
  EXPECT_GT(period, 14ms);
  EXPECT_LT(period, 16ms);
}

TEST_F(InputCommands, StreamFitsTheLongestGroup) {
  send({148, 1, 6});
  const Bytes frames = receive(560, 2s);
  send({150, 0});
  ASSERT_EQ(frames.size(), 560U);
  bool including = true;
  bool excluding = true;
  for (std::size_t at = 0; at < frames.size(); at += 56) {
    const std::span<const std::uint8_t> frame{frames.data() + at, 56};
    EXPECT_EQ(frame[0], 19);
    EXPECT_EQ(frame[1], 53);
    EXPECT_EQ(frame[2], 6);
    including = including && oi::checksum_matches(frame, oi::Checksum::including_header);
    excluding = excluding && oi::checksum_matches(frame, oi::Checksum::excluding_header);
  }
  EXPECT_NE(including, excluding) << "one of the two, always the same";
}

TEST_F(InputCommands, StreamCountsItsPackets) {
  EXPECT_EQ(ask({148, 3, 7, 8, 9, 150, 0, 142, 38}, 1).size(), 1U);
  wait(100ms);
  EXPECT_EQ(packet(38), 3);
}

TEST_F(InputCommands, ARepliesBytesAreNotInAFrame) {
  send({148, 2, 35, 37});
  (void)receive(7);
  send({150, 0});
  wait(50ms);
  EXPECT_EQ(mode(), 1);
  send({150, 1});
  const Bytes frames = receive(14);
  ASSERT_EQ(frames.size(), 14U);
  EXPECT_EQ(frames[0], 19);
  EXPECT_EQ(frames[7], 19);
}

TEST_F(InputCommands, StreamIsPausedResumedAndReplaced) {
  send({148, 1, 35});
  (void)receive(5);
  send({150, 0});
  wait(100ms);
  EXPECT_TRUE(listen(100ms).empty());
  EXPECT_EQ(packet(38), 1);
  send({150, 1});
  EXPECT_EQ(receive(5).size(), 5U);
  send({148, 2, 35, 37});
  wait(100ms);
  const Bytes frames = receive(14);
  send({148, 0});
  const std::array<std::uint8_t, 3> of_two{19, 4, 35};
  EXPECT_NE(std::search(frames.begin(), frames.end(), of_two.begin(), of_two.end()), frames.end());
  wait(100ms);
  EXPECT_TRUE(listen(100ms).empty());
}

TEST_F(InputCommands, AStreamOfMoreThanFortyThreePacketsIsNotTaken) {
  send({148, 2, 35, 37});
  (void)receive(7);
  Bytes longer{148, 44};
  longer.resize(46, 35);
  send(longer);
  wait(100ms);
  const Bytes frames = receive(7);
  send({150, 0});
  ASSERT_EQ(frames.size(), 7U);
  EXPECT_EQ(frames[1], 4) << "the one before goes on";
}

TEST_F(InputCommands, StreamOutlastsAChangeOfMode) {
  send({148, 1, 35});
  send({132});
  wait(100ms);
  const Bytes frames = receive(10);
  send({150, 0});
  const std::array<std::uint8_t, 3> full{2, 35, 3};
  EXPECT_NE(std::search(frames.begin(), frames.end(), full.begin(), full.end()), frames.end());
}

// --- Scripts (OI p. 15) ---

TEST_F(ScriptCommands, ShowReturnsWhatWasStored) {
  const Bytes script{13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0};
  Bytes command{152};
  command.insert(command.end(), script.begin(), script.end());
  send(command);
  EXPECT_EQ(ask({154}, script.size()), script);
  send({152, 0});
  EXPECT_EQ(ask({154}, 1), (Bytes{0}));
}

TEST_F(ScriptCommands, HoldAHundredBytes) {
  Bytes command{152, 100};
  command.resize(102, 128);
  send(command);
  EXPECT_EQ(ask({154}, 101).size(), 101U);
}

TEST_F(ScriptCommands, OfMoreThanAHundredBytesAreNotStored) {
  send({152, 2, 128, 128});
  Bytes longer{152, 101};
  longer.resize(103, 132);
  send(longer);
  EXPECT_EQ(ask({154}, 3), (Bytes{2, 128, 128}));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(ScriptCommands, ShowHaltsTheStream) {
  send({152, 0, 148, 1, 35});
  (void)receive(5);
  send({154});
  wait(100ms);
  EXPECT_TRUE(listen(100ms).empty());
  send({150, 1});
  EXPECT_EQ(receive(5).size(), 5U);
}

TEST_F(ScriptCommands, ArePlayed) {
  send({152, 3, 132, 142, 35});
  EXPECT_EQ(mode(), 1) << "stored is not played";
  EXPECT_EQ(ask({153}, 1), (Bytes{3}));
  EXPECT_EQ(ask({153}, 1), (Bytes{3})) << "and again";
}

TEST_F(ScriptCommands, AreKeptThroughModesAndReplacedByTheNext) {
  send({152, 2, 128, 128, 132, 131, 128});
  EXPECT_EQ(ask({154}, 3), (Bytes{2, 128, 128}));
  send({152, 1, 128});
  EXPECT_EQ(ask({154}, 2), (Bytes{1, 128}));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(ScriptCommands, DriveAndTellWhenTheyAreThrough) {
  (void)moved_within(0ms);
  send({152, 18, 132, 137, 0, 100, 128, 0, 156, 0, 40, 137, 0, 0, 128, 0, 128, 149, 1, 35, 153});
  EXPECT_EQ(receive(1, 5s), (Bytes{1}));
  wait(500ms);
  const std::int16_t moved = word_packet(19);
  EXPECT_GE(moved, 36);
  EXPECT_LT(moved, 80);
}

TEST_F(ScriptCommands, LoopWithPlayScriptAsTheirLastCommand) {
  send({152, 5, 142, 35, 155, 1, 153, 153});
  const Bytes ticks = receive(5, 3s);
  send({152, 0});  // the next round plays an empty script
  EXPECT_EQ(ticks, (Bytes{1, 1, 1, 1, 1}));
  wait(500ms);
  EXPECT_EQ(mode(), 1);
}

// --- Waits (OI p. 15, 16) ---

TEST_F(WaitCommands, WaitTimeHoldsBackWhatComesBehindIt) {
  const rt::TimePoint before = stream().now();
  EXPECT_EQ(ask({155, 5, 142, 35}, 1), (Bytes{1}));
  const rt::Duration waited = stream().now() - before;
  EXPECT_GE(waited, 490ms);
  EXPECT_LT(waited, 800ms);
}

TEST_F(WaitCommands, WaitDistanceEndsThere) {
  send({132, 137, 0, 100, 128, 0, 156, 0, 50, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  EXPECT_GE(distance, 45);
  EXPECT_LT(distance, 90);
}

TEST_F(WaitCommands, WaitAngleEndsThere) {
  send({132, 137, 0, 100, 0xff, 0xff, 157, 0xff, 0xe2, 137, 0, 0, 128, 0, 142, 35});  // -30 degrees
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_LE(angle, -26);
  EXPECT_GT(angle, -60);
}

TEST_F(WaitCommands, WaitAngleGoesCounterClockwiseToo) {
  send({132, 137, 0, 100, 0, 1, 157, 0, 30, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_GE(angle, 26);
  EXPECT_LT(angle, 60);
}

TEST_F(WaitCommands, WaitDistanceClearsTheDistance) {
  (void)moved_within(0ms);
  send({132, 145, 0, 150, 0, 150});
  wait(1s);
  send({156, 0, 20, 149, 1, 19});
  const Bytes distance = receive(2, 5s);
  send({145, 0, 0, 0, 0});
  ASSERT_EQ(distance.size(), 2U);
  EXPECT_EQ(distance[0], 0);
  EXPECT_GE(distance[1], 19);
  EXPECT_LT(distance[1], 40) << "what was driven before is forgotten";
  wait(500ms);
}

TEST_F(WaitCommands, WaitAngleClearsTheAngle) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 150, 0, 1});
  wait(1s);
  send({157, 0, 10, 149, 1, 20});
  const Bytes angle = receive(2, 5s);
  send({137, 0, 0, 0, 0});
  ASSERT_EQ(angle.size(), 2U);
  EXPECT_EQ(angle[0], 0);
  EXPECT_GE(angle[1], 9);
  EXPECT_LT(angle[1], 30) << "what was turned before is forgotten";
  wait(500ms);
}

TEST_F(WaitCommands, WaitDistanceGoesBackwardToo) {
  send({132, 137, 0xff, 0x9c, 128, 0, 156, 0xff, 0xce, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  EXPECT_LE(distance, -45);
  EXPECT_GT(distance, -90);
}

// Backward too, and clockwise: a 0 that is only reached going forward would never end.
TEST_F(WaitCommands, NoDistanceAndNoAngleEndAtOnce) {
  send({132, 137, 0xff, 0x9c, 128, 0});
  wait(300ms);
  send({156, 0, 0, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 1s), (Bytes{3}));
  send({137, 0, 100, 0xff, 0xff});
  wait(300ms);
  send({157, 0, 0, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 1s), (Bytes{3}));
}

TEST_F(WaitCommands, SilenceTheStream) {
  send({148, 1, 35});
  (void)receive(5);
  send({155, 5});
  wait(100ms);
  EXPECT_TRUE(listen(300ms).empty());
  EXPECT_EQ(receive(5).size(), 5U);
  send({150, 0});
}

TEST_F(WaitCommands, AreDeafAndKeepWhatTheyHear) {
  send({155, 4});
  wait(50ms);
  send({132, 142, 35});
  EXPECT_TRUE(listen(200ms).empty());
  EXPECT_EQ(receive(1), (Bytes{3}));
}

TEST_F(WaitCommands, WaitEventSeesWhatIsSoAlready) {
  EXPECT_EQ(ask({158, 22, 142, 35}, 1), (Bytes{1})) << "Passive";
  EXPECT_EQ(ask({158, 251, 142, 35}, 1), (Bytes{1})) << "no bump";
}

}  // namespace
}  // namespace cargobay::conformance
