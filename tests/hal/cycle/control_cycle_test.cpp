#include "hal/cycle/control_cycle.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <span>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::expect_stopped;
using test::forward;
using test::VirtualDrive;

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
