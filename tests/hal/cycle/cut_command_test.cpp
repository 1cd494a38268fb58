// A line that goes dead in the middle of a command: the robot waits for the rest, and must not take
// the next command for it. A robot that is deaf anyway is noticed and freed.

#include <gtest/gtest.h>

#include "oi/command_table.hpp"
#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::VirtualDrive;

constexpr std::size_t kLongestAnswer =
    oi::kDriveDirectBytes + 2 + oi::kCreate.list(oi::FrameList::reading).size();

rt::WheelSpeeds turns_after_3_s(double seconds) {
  return seconds < 3.0 ? rt::WheelSpeeds{211.0, 187.0} : rt::WheelSpeeds{-103.0, 77.0};
}

// The first answer of maximum length from frame 100 on: `carried` bytes of it reach the robot, and
// then nothing passes in either direction for `silent` frames.
class Cut {
 public:
  Cut(VirtualDrive& drive, std::size_t carried, int silent) : silent_{silent} {
    drive.cuts_commands = true;
    drive.on_frame = [this](int now, ControlCycle&) { frame_ = now; };
    drive.line.carry = [this, carried](std::span<const std::uint8_t> bytes) {
      if (frame_ < 100 || done_) return bytes.size();
      if (dead_) return std::size_t{0};
      dead_ = bytes.size() == kLongestAnswer;
      return dead_ ? carried : bytes.size();
    };
    drive.line.damage = [this](std::span<std::uint8_t> bytes) {
      if (!dead_ || done_) return bytes.size();
      done_ = --silent_ <= 0;
      return std::size_t{0};
    };
  }
  bool done() const { return done_; }

 private:
  int silent_;
  int frame_ = 0;
  bool dead_ = false;
  bool done_ = false;
};

// Commands that the robot took for drive commands but that were not sent as such.
int commands_nobody_sent(const DriveResult& result) {
  int strange = 0;
  for (const sim::DriveRecord& record : result.commands) {
    const auto sent = [&record](const test::Tick& tick) {
      return tick.state.command ==
             rt::WheelSpeeds{record.command.left_mm_s, record.command.right_mm_s};
    };
    const bool stop = record.command == sim::WheelSpeeds{};
    if (!stop && std::ranges::none_of(result.ticks, sent)) ++strange;
  }
  return strange;
}

TEST(CutCommand, IsFilledUpWhereverItIsCut) {
  for (std::size_t carried = 0; carried < kLongestAnswer; ++carried) {
    for (const int silent : {1, 3, 8}) {
      VirtualDrive drive{sim::Parameters{.remainder = sim::Remainder::carried}};
      const Cut cut{drive, carried, silent};
      const DriveResult result = drive.run(400, turns_after_3_s);
      ASSERT_TRUE(cut.done());
      EXPECT_EQ(result.end, CycleEnd::asked) << carried;
      EXPECT_EQ(result.frames.lost, static_cast<std::uint64_t>(silent)) << carried;
      EXPECT_EQ(result.frames.bad, 0U) << carried;
      // The cut one itself may be half of one.
      EXPECT_LE(commands_nobody_sent(result), 1) << carried;
      EXPECT_EQ(drive.device.counters().commands_refused, 0U) << carried;
      EXPECT_NEAR(result.ticks.back().truth.left_mm_s, -103.0, 10.0) << carried;
    }
  }
}

// For 510 bytes the line shows nothing, and frames keep coming. The list is what shows it.
TEST(CutCommand, ThatARobotWaitsForTheRestOfIsFoundOut) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    VirtualDrive drive{sim::Parameters{.remainder = remainder}};
    constexpr int kDeafFrom = 180;
    // Up to 20 ticks to the next list, four frames without it, 510 bytes at 64 a tick.
    constexpr int kFreedBy = kDeafFrom + 20 + 4 + 8;
    rt::WheelSpeeds commanded{};
    drive.on_frame = [&](int frame, ControlCycle&) {
      if (frame == kDeafFrom) drive.device.take_half_command();
      if (frame == kFreedBy) commanded = drive.device.commanded();
    };
    const DriveResult result = drive.run(400, turns_after_3_s);
    EXPECT_EQ(result.end, CycleEnd::asked);
    EXPECT_EQ(result.frames.lost, 0U);
    // By the answer to the frame before.
    const test::Tick& told = result.ticks.at(kFreedBy - 2);
    EXPECT_EQ(commanded, told.state.command);
    EXPECT_NEAR(result.ticks.back().truth.left_mm_s, -103.0, 10.0);
    EXPECT_TRUE(result.confirmed_passive);
  }
}

TEST(DamagedHeader, MakesAFrameABadOneAndNotALostOne) {
  VirtualDrive drive{sim::Parameters{}};
  int frames = 0;
  std::uint64_t damaged = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    ++frames;
    if (frames >= 100 && frames < 200 && frames % 3 != 0) {
      bytes[0] ^= 4U;
      ++damaged;
    }
    return bytes.size();
  };
  const DriveResult result = drive.run(300, turns_after_3_s);
  EXPECT_GT(damaged, 60U);
  EXPECT_EQ(result.frames.bad, damaged);
  EXPECT_EQ(result.frames.lost, 0U);
  EXPECT_EQ(drive.device.counters().unknown_opcodes, 0U)
      << "no byte was missing: none is filled up";
}

}  // namespace
}  // namespace cargobay::hal
