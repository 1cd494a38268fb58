#include "hal/cycle/control_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::forward;
using test::VirtualDrive;

void expect_stopped(const VirtualDrive& drive) {
  EXPECT_EQ(drive.device.mode(), oi::Mode::passive);
  EXPECT_EQ(drive.device.commanded(), rt::WheelSpeeds{});
}

TEST(ControlCycle, AnswersEachFrameWithOneCommand) {
  VirtualDrive drive{sim::Parameters{}};
  const DriveResult result = drive.run(300, forward);
  EXPECT_EQ(result.frames.good, 300U);
  EXPECT_EQ(result.frames.late, 0U);
  // One per frame, then the stop of the cycle and that of farewell().
  EXPECT_EQ(result.commands.size(), 302U);
  expect_stopped(drive);
}

TEST(ControlCycle, NeverSendsTwoCommandsInOneTick) {
  for (const auto kind : {sim::Remainder::carried, sim::Remainder::lost}) {
    VirtualDrive drive{sim::Parameters{.remainder = kind}};
    const DriveResult result = drive.run(1000, forward);
    std::map<std::uint64_t, int> in_tick;
    for (std::size_t i = 0; i + 2 < result.commands.size(); ++i) ++in_tick[result.commands[i].tick];
    for (const auto& [tick, count] : in_tick) EXPECT_EQ(count, 1) << "in tick " << tick;
  }
}

TEST(ControlCycle, LimitsAcceleration) {
  VirtualDrive drive{sim::Parameters{}};
  ControlCycle::Parameters parameters;
  parameters.loop.limits.acceleration_mm_s2 = 400.0;
  const DriveResult result = drive.run(200, forward, parameters);
  double before = 0.0;
  for (const test::Tick& tick : result.ticks) {
    EXPECT_LE(std::abs(tick.state.set.left_mm_s - before), 400.0 * 0.015 + 1e-9);
    before = tick.state.set.left_mm_s;
  }
  EXPECT_EQ(before, 200.0);
}

TEST(ControlCycle, StandsStillForAControlFunctionThatReturnsNoNumber) {
  VirtualDrive drive{sim::Parameters{}};
  const DriveResult result = drive.run(
      100, [](double) { return rt::WheelSpeeds{std::numeric_limits<double>::quiet_NaN(), 100.0}; });
  EXPECT_EQ(result.ticks.back().state.command, rt::WheelSpeeds{});
  EXPECT_EQ(result.refused_controls, 100U);
  ASSERT_EQ(result.events.size(), 1U) << "told once";
  EXPECT_EQ(result.events[0].what, EventKind::control_refused);
}

TEST(ControlCycle, StandsStillForAControlFunctionThatAsksTooMuch) {
  VirtualDrive drive{sim::Parameters{}};
  const DriveResult result = drive.run(100, [](double) { return rt::WheelSpeeds{501.0, 0.0}; });
  EXPECT_EQ(result.ticks.back().state.command, rt::WheelSpeeds{});
  EXPECT_EQ(result.refused_controls, 100U);
}

TEST(ControlCycle, TellsAgainOfAControlFunctionThatWasSaneBetween) {
  VirtualDrive drive{sim::Parameters{}};
  int calls = 0;
  const DriveResult result = drive.run(600, [&calls](double) {
    return ++calls % 2 == 0 ? rt::WheelSpeeds{0.0, 600.0} : rt::WheelSpeeds{};
  });
  EXPECT_EQ(result.refused_controls, 300U);
  EXPECT_EQ(result.events.size(), kMostEvents) << "nobody took them";
  EXPECT_EQ(result.events_dropped, 300U - kMostEvents);
}

// Runs a cycle that follows setpoints, not a control function. `each` is called for every frame
// that arrives, and may end the cycle.
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

// Setpoints from outside, without a control function.
class Setpoints : public testing::Test {
 protected:
  // Runs for `frames` frames; `each` is called before each frame is read.
  CycleEnd run(int frames, std::function<void(int)> each) {
    EXPECT_TRUE(bring_up(link_, {.packets = oi::kCreate.list(oi::FrameList::reading)}));
    EXPECT_FALSE(link_.set_wake_threshold(oi::kCreate.frame_bytes));
    int frame = 0;
    line_.damage = [&](std::span<std::uint8_t> bytes) {
      each(++frame);
      if (frame >= frames) cycle_.request_stop();
      return bytes.size();
    };
    return cycle_.run();
  }

  sim::Device device_{sim::Parameters{}};
  sim::VirtualLink link_{device_};
  test::DamagedStream line_{link_};
  ControlCycle cycle_{line_, {}};
};

TEST_F(Setpoints, LapseAfterHalfASecond) {
  std::map<int, rt::WheelSpeeds> commanded;
  run(100, [&](int frame) {
    if (frame == 1) {
      EXPECT_TRUE(cycle_.set_speeds({200.0, 200.0}));
    }
    commanded[frame] = device_.commanded();
  });
  EXPECT_NE(commanded[33], rt::WheelSpeeds{});  // 0.48 s
  EXPECT_EQ(commanded[60], rt::WheelSpeeds{});  // the acceleration limit included
}

TEST_F(Setpoints, StayLapsedUntilANewOneIsSet) {
  run(600, [&](int frame) {
    if (frame == 1 || frame == 500) {
      EXPECT_TRUE(cycle_.set_speeds({200.0, 200.0}));
    }
    if (frame > 70 && frame <= 500) {
      EXPECT_EQ(device_.commanded(), rt::WheelSpeeds{}) << frame;
    }
    if (frame == 520) {
      EXPECT_GT(device_.commanded().left_mm_s, 150.0) << "the same speeds, set again";
    }
  });
  Event event;
  int lapses = 0;
  while (cycle_.next_event(event)) lapses += event.what == EventKind::setpoint_lapsed ? 1 : 0;
  EXPECT_EQ(lapses, 2);
}

TEST_F(Setpoints, LastWhileTheyAreRenewed) {
  run(200, [&](int frame) {
    if (frame % 20 == 1) {
      EXPECT_TRUE(cycle_.set_speeds({200.0, 200.0}));
    }
    if (frame > 30) {
      EXPECT_GT(device_.commanded().left_mm_s, 150.0);
    }
  });
}

TEST_F(Setpoints, AreNoneAtTheStart) {
  run(50, [&](int) { EXPECT_EQ(device_.commanded(), rt::WheelSpeeds{}); });
  EXPECT_TRUE(cycle_.state()->setpoint_lapsed);
}

TEST_F(Setpoints, AreRefusedOutOfRange) {
  EXPECT_FALSE(cycle_.set_speeds({500.5, 0.0}));
  EXPECT_FALSE(cycle_.set_speeds({0.0, -500.5}));
  EXPECT_FALSE(cycle_.set_speeds({std::numeric_limits<double>::quiet_NaN(), 0.0}));
  EXPECT_FALSE(cycle_.set_speeds({0.0, std::numeric_limits<double>::infinity()}));
  EXPECT_TRUE(cycle_.set_speeds({500.0, -500.0}));
}

ControlCycle::Parameters gentle() {
  ControlCycle::Parameters parameters;
  parameters.loop.limits = {.acceleration_mm_s2 = 100.0, .jerk_mm_s3 = 1000.0};
  return parameters;
}

// 200 mm/s after 2 s; then nobody steers.
TEST(ControlCycle, StandsAtOnceWhereNobodySteersHoweverGentleItsLimits) {
  using Kind = ControlAnswer::Kind;
  const double kBad = std::numeric_limits<double>::infinity();
  for (const ControlAnswer& then : {ControlAnswer{Kind::stand}, ControlAnswer{Kind::setpoint},
                                    ControlAnswer{rt::WheelSpeeds{kBad, 0.0}}}) {
    VirtualDrive drive{sim::Parameters{}};
    const DriveResult result = drive.run(
        220, [&](double seconds) { return seconds < 2.5 ? ControlAnswer{forward(seconds)} : then; },
        gentle());
    ASSERT_EQ(result.end, CycleEnd::asked);
    int standing = 0;
    for (const test::Tick& tick : result.ticks) {
      if (!tick.state.setpoint_lapsed) continue;
      ++standing;
      EXPECT_EQ(tick.state.set, rt::WheelSpeeds{});
      EXPECT_EQ(tick.state.command, rt::WheelSpeeds{});
    }
    EXPECT_GT(standing, 40);
    EXPECT_GT(result.ticks[result.ticks.size() - 60].state.set.left_mm_s, 150.0) << "it drove";
  }
}

TEST(ControlCycle, EndsWhenItsControlFunctionHasFinished) {
  VirtualDrive drive{sim::Parameters{}};
  const DriveResult result = drive.run(1000, [](double seconds) {
    return seconds < 1.0 ? ControlAnswer{forward(seconds)}
                         : ControlAnswer{ControlAnswer::Kind::finish};
  });
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_LT(result.ticks.size(), 70U);
  EXPECT_EQ(result.commands.back().command, sim::WheelSpeeds{});
}

TEST(ControlCycle, EndsWhenItsControlFunctionHasFailed) {
  VirtualDrive drive{sim::Parameters{}};
  const DriveResult result = drive.run(1000, [](double seconds) {
    return seconds < 1.0 ? ControlAnswer{forward(seconds)}
                         : ControlAnswer{ControlAnswer::Kind::fail};
  });
  EXPECT_EQ(result.end, CycleEnd::control_failed);
  EXPECT_EQ(result.commands.back().command, sim::WheelSpeeds{});
}

TEST(ControlCycle, FollowsSetpointsWhereItsControlFunctionAsksForThem) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [](int frame, ControlCycle& cycle) {
    if (frame >= 20 && frame < 150) {
      EXPECT_TRUE(cycle.set_speeds({150.0, 150.0}));
    }
    if (frame == 150) cycle.stand_still();
  };
  const DriveResult result =
      drive.run(200, [](double) { return ControlAnswer{ControlAnswer::Kind::setpoint}; });
  EXPECT_TRUE(result.ticks[10].state.setpoint_lapsed);
  EXPECT_FALSE(result.ticks[100].state.setpoint_lapsed);
  EXPECT_EQ(result.ticks[100].state.target, (rt::WheelSpeeds{150.0, 150.0}));
  EXPECT_TRUE(result.ticks[150].state.setpoint_lapsed);
  EXPECT_EQ(result.ticks.back().state.set, rt::WheelSpeeds{});
  EXPECT_TRUE(result.events.empty()) << "a stop that was asked for is no event";
}

}  // namespace
}  // namespace cargobay::hal
