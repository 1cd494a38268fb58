// What any Create does of its manual's Getting Started, Mode and Demos, asked only over its serial
// line, so that any other device can be asked the same.
#include <array>
#include <cstdlib>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "tests/conformance/subject.hpp"

namespace cargobay::conformance {
namespace {

using GettingStartedCommands = Conformance;
using ModeCommands = Conformance;
using DemoCommands = Conformance;

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

}  // namespace
}  // namespace cargobay::conformance
