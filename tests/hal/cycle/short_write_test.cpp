// A port that accepts a part of what it is given: the robot, which waits for the rest, gets it
// before anything else, and never takes one command's bytes for another's.

#include <map>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "hal/cycle/command_sender.hpp"
#include "hal/cycle/outgoing.hpp"
#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::VirtualDrive;

rt::WheelSpeeds turns_after_5_s(double seconds) {
  return seconds < 5.0 ? rt::WheelSpeeds{211.0, 187.0} : rt::WheelSpeeds{-103.0, 77.0};
}

using Speeds = std::set<std::pair<double, double>>;

struct Checked {
  DriveResult result{};
  Speeds offered{};  // to the port: left and right of each DriveDirect, whole or not
  std::uint64_t unknown = 0;
  std::uint64_t refused = 0;
};

// Opcode, right, left; most significant byte first (OI p. 9). May find one too many, in data.
void note_drives(std::span<const std::uint8_t> bytes, Speeds& speeds) {
  constexpr std::uint8_t kDriveDirect = 145;
  const auto word = [&](std::size_t at) {
    return static_cast<double>(
        static_cast<std::int16_t>(static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1])));
  };
  for (std::size_t i = 0; i + 4 < bytes.size(); ++i) {
    if (bytes[i] == kDriveDirect) speeds.insert({word(i + 3), word(i + 1)});
  }
}

Checked drive_over(VirtualDrive& drive) {
  Checked run;
  drive.line.accept = [&run, accept = drive.line.accept](std::span<const std::uint8_t> bytes) {
    note_drives(bytes, run.offered);
    return accept(bytes);
  };
  run.result = drive.run(900, turns_after_5_s);
  run.unknown = drive.device.counters().unknown_opcodes;
  run.refused = drive.device.counters().commands_refused;
  return run;
}

void expect_understood(const Checked& run) {
  EXPECT_EQ(run.result.end, CycleEnd::asked);
  EXPECT_EQ(run.unknown, 0U);
  EXPECT_EQ(run.refused, 0U);
  std::map<std::uint64_t, int> in_tick;
  for (std::size_t i = 0; i + 2 < run.result.commands.size(); ++i) {
    const sim::DriveRecord& record = run.result.commands[i];
    EXPECT_LE(++in_tick[record.tick], 1);
    EXPECT_TRUE(run.offered.contains({record.command.left_mm_s, record.command.right_mm_s}));
  }
  EXPECT_NEAR(run.result.ticks.back().truth.left_mm_s, -103.0, 10.0);
  EXPECT_TRUE(run.result.confirmed_passive);
}

TEST(ShortWrite, AtEachByteOfADriveCommandIsFinishedFirst) {
  for (std::size_t taken = 0; taken < 5; ++taken) {
    VirtualDrive drive{sim::Parameters{}};
    int frame = 0;
    drive.on_frame = [&](int now, ControlCycle&) { frame = now; };
    int last = 0;
    drive.line.accept = [&](std::span<const std::uint8_t> bytes) {
      const bool cut = frame >= 100 && frame % 10 == 0 && frame != last;
      last = frame;
      return cut ? std::min(taken, bytes.size()) : bytes.size();
    };
    const Checked run = drive_over(drive);
    expect_understood(run);
    EXPECT_GE(run.result.unsent_commands, 50U);
  }
}

// Lists too, over and over, down to nothing at all.
TEST(ShortWrite, AnywhereIsFinishedFirst) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    VirtualDrive drive{sim::Parameters{.remainder = seed % 2 == 0 ? sim::Remainder::carried
                                                                  : sim::Remainder::lost}};
    std::mt19937 random{seed};
    int frame = 0;
    drive.on_frame = [&](int now, ControlCycle&) { frame = now; };
    drive.line.accept = [&](std::span<const std::uint8_t> bytes) {
      const bool cut = frame >= 50 && frame < 500 && random() % 3 == 0;
      return cut ? random() % bytes.size() : bytes.size();
    };
    expect_understood(drive_over(drive));
  }
}

// During silence the wheels are told to stop, through a port that accepts a byte at a time.
TEST(ShortWrite, OfAStopIsTriedUntilItIsWhole) {
  VirtualDrive drive{sim::Parameters{}};
  int frame = 0;
  drive.on_frame = [&](int now, ControlCycle&) { frame = now; };
  drive.line.accept = [&](std::span<const std::uint8_t> bytes) -> std::size_t {
    return frame >= 100 ? 1 : bytes.size();
  };
  int swallowed = 0;
  rt::WheelSpeeds at_the_end{1.0, 1.0};
  drive.line.damage = [&](std::span<std::uint8_t> bytes) -> std::size_t {
    if (frame < 100) return bytes.size();
    if (++swallowed < 40) at_the_end = drive.device.commanded();
    return 0;
  };
  const DriveResult result = drive.run(300, turns_after_5_s);
  EXPECT_EQ(result.end, CycleEnd::link_lost);
  EXPECT_EQ(at_the_end, rt::WheelSpeeds{});
  EXPECT_EQ(drive.device.counters().unknown_opcodes, CommandSender::kLongestOwnRest)
      << "zeros, in front of the stop";
}

TEST(Outgoing, ForgetsCommandsThatWereNotBegun) {
  Outgoing out;
  out.add_drive({100.0, -100.0});
  out.add_list(FrameList::hazards);
  ASSERT_EQ(out.bytes().size(), 5U + 4U);
  const Outgoing::Taken taken = out.took(5);
  EXPECT_TRUE(taken.drive);
  EXPECT_EQ(taken.speeds, (rt::WheelSpeeds{100.0, -100.0}));
  EXPECT_FALSE(taken.list);
  EXPECT_TRUE(out.empty());
}

TEST(Outgoing, TellsTheRestOfACommandFromTheOneBehindIt) {
  Outgoing out;
  out.add_drive({300.0, 200.0});
  EXPECT_TRUE(out.took(2).missed_drive);
  out.add_drive({});
  const Outgoing::Taken taken = out.took(3);
  EXPECT_TRUE(taken.drive);
  EXPECT_EQ(taken.speeds, (rt::WheelSpeeds{300.0, 200.0}));
  EXPECT_TRUE(taken.missed_drive) << "the stop";
  EXPECT_TRUE(out.empty());
}

TEST(Outgoing, KeepsTheRestThroughWritesThatTakeNothing) {
  Outgoing out;
  out.add_drive({300.0, 200.0});
  EXPECT_FALSE(out.took(2).drive);
  out.add_drive({1.0, 2.0});
  EXPECT_FALSE(out.took(0).drive);
  ASSERT_EQ(out.bytes().size(), 3U);
  EXPECT_TRUE(out.drives());
  const Outgoing::Taken taken = out.took(3);
  EXPECT_TRUE(taken.drive);
  EXPECT_EQ(taken.speeds, (rt::WheelSpeeds{300.0, 200.0}));
  EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace cargobay::hal
