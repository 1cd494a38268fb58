#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "hal/cycle/control_cycle.hpp"
#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::expect_stopped;
using test::forward;
using test::VirtualDrive;

// How far a drive is, for damage at a certain frame.
class Damage {
 public:
  explicit Damage(VirtualDrive& drive) : drive_{drive} {
    drive_.on_frame = [this](int frame, ControlCycle&) { frame_ = frame; };
  }
  int frame() const { return frame_; }

 private:
  VirtualDrive& drive_;
  int frame_ = 0;
};

TEST(ControlCycle, CountsAndSurvivesDamagedFrames) {
  VirtualDrive drive{sim::Parameters{}};
  std::mt19937 random{7};
  int flipped = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    if (bytes.size() == oi::kCreate.frame_bytes && random() % 10 == 0) {
      bytes[2 + random() % 8] ^= 0x40;
      ++flipped;
    }
    return bytes.size();
  };
  const std::uint64_t before = drive.device.counters().frames_sent;
  const DriveResult result = drive.run(1000, forward);
  ASSERT_TRUE(result.brought_up);
  EXPECT_EQ(before, 0U);
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_GE(result.frames.good, 1000U);
  EXPECT_GT(flipped, 50);
  // Those during bring-up were not the cycle's, and the last may not have been confirmed yet.
  EXPECT_LE(result.frames.bad + result.frames.lost, static_cast<std::uint64_t>(flipped));
  EXPECT_GE(result.frames.bad + result.frames.lost + 3, static_cast<std::uint64_t>(flipped));
  const rt::WheelSpeeds truth = result.ticks.back().truth;
  EXPECT_NEAR(truth.left_mm_s, 200.0, 10.0);
  EXPECT_NEAR(truth.right_mm_s, 200.0, 10.0);
  expect_stopped(drive);
}

TEST(ControlCycle, CountsLostFrames) {
  VirtualDrive drive{sim::Parameters{}};
  Damage progress{drive};
  int dropped = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) -> std::size_t {
    if (progress.frame() > 100 && progress.frame() % 50 == 0 && dropped < progress.frame() / 50) {
      ++dropped;
      return 0;
    }
    return bytes.size();
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_GT(dropped, 10);
  EXPECT_LE(result.frames.lost, static_cast<std::uint64_t>(dropped));
  EXPECT_GE(result.frames.lost + 1, static_cast<std::uint64_t>(dropped));
  EXPECT_EQ(result.frames.bad, 0U);
}

TEST(ControlCycle, StopsTheWheelsInSilenceAndGoesOnBehindIt) {
  VirtualDrive drive{sim::Parameters{}};
  Damage progress{drive};
  int swallowed = 0;
  rt::WheelSpeeds in_silence{1.0, 1.0};
  drive.line.damage = [&](std::span<std::uint8_t> bytes) -> std::size_t {
    if (progress.frame() != 200 || swallowed >= 20) return bytes.size();
    ++swallowed;
    in_silence = drive.device.commanded();
    return 0;
  };
  const DriveResult result = drive.run(500, forward);
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_EQ(in_silence, rt::WheelSpeeds{});
  EXPECT_NEAR(static_cast<double>(result.frames.lost), 20.0, 1.0);
  std::map<EventKind, int> told;
  for (const Event& event : result.events) ++told[event.what];
  EXPECT_EQ(told[EventKind::silence_began], 1);
  EXPECT_EQ(told[EventKind::silence_ended], 1);
  EXPECT_EQ(told[EventKind::frames_lost], 1);
  EXPECT_NEAR(result.ticks.back().truth.left_mm_s, 200.0, 10.0);
  // Starts from rest, by the acceleration limit: no jump.
  const std::size_t behind = 201;
  EXPECT_LT(result.ticks[behind].state.set.left_mm_s, 50.0);
}

// Of the estimate once the wheels are known a little. An estimate that a silence made up is off by
// up to 190 mm/s.
constexpr double kWorstError = 25.0;
constexpr std::size_t kFirstSteps = 100;  // ticks

double worst_error(const DriveResult& result) {
  double worst = 0.0;
  for (const test::Tick& tick : std::span{result.ticks}.subspan(kFirstSteps)) {
    worst = std::max(worst, std::abs(tick.state.estimate.left_mm_s - tick.truth.left_mm_s));
  }
  return worst;
}

// The second frame after it shows how many ticks it lasted.
TEST(ControlCycle, PublishesNoEstimateThatASilenceMadeUp) {
  for (const int silent : {4, 7, 9, 12, 40}) {
    VirtualDrive drive{sim::Parameters{}};
    drive.on_frame = [&](int frame, ControlCycle&) {
      if (frame == 200)
        drive.device.faults().stalled_until = drive.device.now() + silent * oi::kTick;
    };
    const DriveResult result = drive.run(400, forward);
    EXPECT_EQ(result.end, CycleEnd::asked);
    EXPECT_EQ(result.frames.good, 401U) << silent << ": one of them unanswered";
    EXPECT_EQ(result.frames.lost, static_cast<std::uint64_t>(silent)) << silent;
    EXPECT_LT(worst_error(result), kWorstError) << silent;
  }
}

// The frame that read a window is lost, and this is not known yet; the next one reads a tick.
TEST(ControlCycle, DoesNotTakeATickForAWindow) {
  VirtualDrive drive{sim::Parameters{.remainder = sim::Remainder::lost}};
  Damage progress{drive};
  bool dropped = false;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) -> std::size_t {
    const bool reads = bytes.size() == oi::kCreate.frame_bytes && bytes[4] == 19;  // the distance
    if (dropped || progress.frame() < 500 || !reads) return bytes.size();
    dropped = true;
    return 0;
  };
  const DriveResult result = drive.run(800, forward);
  EXPECT_TRUE(dropped);
  EXPECT_EQ(result.frames.lost, 1U);
  EXPECT_LT(worst_error(result), kWorstError);
}

void hear(sim::Device& device, const std::vector<std::uint8_t>& bytes) {
  for (const std::uint8_t byte : bytes) device.receive(byte);
}

// A command that was damaged in transit may have been another Stream.
TEST(ControlCycle, TellsARobotThatMisheardItsListAgain) {
  for (const std::uint8_t other : std::initializer_list<std::uint8_t>{7, 21, 22}) {
    VirtualDrive drive{sim::Parameters{}};
    drive.on_frame = [&](int frame, ControlCycle&) {
      if (frame == 200) hear(drive.device, {148, 2, 35, other});
    };
    const DriveResult result = drive.run(300, forward);
    EXPECT_EQ(result.end, CycleEnd::asked);
    EXPECT_EQ(result.frames.good, 300U);
    const auto streamed = drive.device.stream().packets();
    const auto is_streamed = [&streamed](FrameList list) {
      return std::ranges::equal(streamed, oi::kCreate.list(list), {}, {},
                                [](oi::PacketId id) { return static_cast<std::uint8_t>(id); });
    };
    EXPECT_TRUE(is_streamed(FrameList::reading) || is_streamed(FrameList::hazards) ||
                is_streamed(FrameList::battery))
        << int{other};
    EXPECT_LT(worst_error(result), kWorstError) << int{other};
  }
}

TEST(ControlCycle, KeepsTheModeOfARobotThatMisheardItsList) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int frame, ControlCycle&) {
    if (frame == 200) hear(drive.device, {148, 1, 7});
  };
  const DriveResult result = drive.run(300, forward);
  for (const test::Tick& tick : result.ticks) EXPECT_EQ(tick.state.mode, oi::Mode::safe);
}

TEST(ControlCycle, CountsTheFramesOfALinkThatIsLost) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&drive](int frame, ControlCycle&) {
    if (frame == 200) drive.device.faults().stalled_until = std::chrono::seconds{60};
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::link_lost);
  EXPECT_EQ(result.frames.good, 200U);
  EXPECT_EQ(result.frames.lost, 67U) << "a second's worth";
}

TEST(ControlCycle, EndsWhereTheRobotFallsSilent) {
  VirtualDrive drive{sim::Parameters{}};
  Damage progress{drive};
  drive.line.damage = [&](std::span<std::uint8_t> bytes) -> std::size_t {
    return progress.frame() >= 200 ? 0 : bytes.size();
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::link_lost);
  EXPECT_EQ(result.ticks.size(), 200U);
  expect_stopped(drive);
}

// While a script waits the robot neither hears nor answers: if announced, that is not a lost link,
// and has no other effect.
TEST(ControlCycle, OutlastsASilenceThatWasAnnounced) {
  VirtualDrive drive{sim::Parameters{}};
  rt::TimePoint announced{};
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 100) {
      announced = drive.link.now();
      cycle.expect_silence(std::chrono::seconds{3});
    }
  };
  drive.line.damage = [&](std::span<std::uint8_t> bytes) -> std::size_t {
    const rt::Duration since = drive.link.now() - announced;
    const bool silent = announced != rt::TimePoint{} && since < std::chrono::milliseconds{2900};
    const bool silent_again = announced != rt::TimePoint{} && since > std::chrono::seconds{4};
    return silent || silent_again ? 0 : bytes.size();
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::link_lost);
  EXPECT_GT(result.ticks.size(), 160U) << "it drives on after the silence";
  EXPECT_LT(result.ticks.size(), 180U) << "of the second one nobody said anything";
}

TEST(ControlCycle, EndsWhereThePortHangsUp) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&drive](int frame, ControlCycle&) {
    if (frame == 100) drive.link.hang_up();
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::hung_up);
  EXPECT_FALSE(result.confirmed_passive);
}

TEST(ControlCycle, EndsWhereTheRobotLeavesItsMode) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&drive](int frame, ControlCycle&) {
    if (frame == 100) drive.device.inputs().cliff_front_left.cliff = true;
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::mode_lost);
  EXPECT_LE(result.ticks.size(), 103U);
  expect_stopped(drive);
}

TEST(ControlCycle, DrivesOverACliffInFull) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&drive](int frame, ControlCycle&) {
    if (frame == 100) drive.device.inputs().cliff_front_left.cliff = true;
  };
  const DriveResult result = drive.run(300, forward, {.drive_mode = oi::Mode::full});
  EXPECT_EQ(result.end, CycleEnd::asked);
  expect_stopped(drive);
}

}  // namespace
}  // namespace cargobay::hal
