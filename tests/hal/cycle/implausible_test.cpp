// Counters that cannot be true, wheels that cannot turn, and speeds out of reach, through the whole
// cycle on the virtual Create.
#include <algorithm>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::forward;
using test::VirtualDrive;
using Finding = rt::WheelWatch::Finding;

constexpr int kBreaksAtFrame = 300;  // frames; the drive may take twice as many
constexpr int kTicksOfASecond = 67;

std::vector<Event> told_of(const DriveResult& result, EventKind what) {
  std::vector<Event> events;
  for (const Event& event : result.events) {
    if (event.what == what) events.push_back(event);
  }
  return events;
}

// With a limit of acceleration that takes 20 s to stop.
CycleParameters gently(OnImplausible what = OnImplausible::end) {
  CycleParameters parameters{.on_implausible = what};
  parameters.loop.limits.acceleration_mm_s2 = 10.0;
  return parameters;
}

struct Broken {
  sim::Remainder remainder = sim::Remainder::carried;
  std::function<void(sim::Device&)> fault{};
  CycleParameters parameters{};
};

DriveResult drive_until_broken(const Broken& setup) {
  VirtualDrive drive{sim::Parameters{.remainder = setup.remainder}};
  drive.on_frame = [&](int frame, ControlCycle&) {
    if (frame == kBreaksAtFrame) setup.fault(drive.device);
  };
  return drive.run(2 * kBreaksAtFrame, forward, setup.parameters);
}

void miss_left(sim::Device& device, double part) {
  sim::WheelParameters wheels = device.parameters().wheels;
  wheels.missed_left = part;
  device.set_wheels(wheels);
}

// The last command is a stop at once, whatever the limit of acceleration.
void expect_hard_stop(const DriveResult& result) {
  const auto last = std::ranges::find_if(
      result.commands.rbegin(), result.commands.rend(),
      [](const sim::DriveRecord& it) { return it.command != sim::WheelSpeeds{}; });
  ASSERT_NE(last, result.commands.rend());
  ASSERT_NE(last, result.commands.rbegin()) << "and then a stop";
  EXPECT_GT(last->command.right_mm_s, 100.0);
}

TEST(Implausible, ADeadCounterEndsTheDriveWithinASecond) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    const DriveResult result = drive_until_broken(
        {.remainder = remainder, .fault = [](sim::Device& it) { miss_left(it, 1.0); }});
    EXPECT_EQ(result.end, CycleEnd::implausible);
    EXPECT_TRUE(result.confirmed_passive);
    const auto events = told_of(result, EventKind::counters_implausible);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].finding, Finding::still);
    EXPECT_EQ(events[0].wheels, oi::BitSet<Wheel>{}.with(Wheel::left));
    EXPECT_FALSE(events[0].overcurrents.any());
    EXPECT_LE(events[0].tick, kBreaksAtFrame + kTicksOfASecond);
    EXPECT_GT(events[0].wanted.left_mm_s, 100.0);
    EXPECT_LT(events[0].got.left_mm_s, 60.0);
    expect_hard_stop(result);
  }
}

TEST(Implausible, AStuckWheelIsToldByItsCurrent) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    const DriveResult result = drive_until_broken(
        {.remainder = remainder, .fault = [](sim::Device& it) { it.set_stuck(sim::Side::right); }});
    EXPECT_EQ(result.end, CycleEnd::implausible);
    const auto events = told_of(result, EventKind::wheel_stuck);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].wheels, oi::BitSet<Wheel>{}.with(Wheel::right));
    EXPECT_TRUE(events[0].overcurrents.has(oi::Overcurrent::right_wheel));
    EXPECT_LE(events[0].tick, kBreaksAtFrame + kTicksOfASecond);
    EXPECT_TRUE(told_of(result, EventKind::counters_implausible).empty());
  }
}

TEST(Implausible, HalfAnEncoderEndsTheDriveWithinFiveSeconds) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    const DriveResult result = drive_until_broken(
        {.remainder = remainder, .fault = [](sim::Device& it) { miss_left(it, 0.5); }});
    EXPECT_EQ(result.end, CycleEnd::implausible);
    const auto events = told_of(result, EventKind::counters_implausible);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].finding, Finding::few);
    EXPECT_LE(events[0].tick, kBreaksAtFrame + 5 * kTicksOfASecond);
  }
}

TEST(Implausible, IsOnlyReportedOnceIfTheDriveIsToGoOn) {
  const DriveResult result =
      drive_until_broken({.fault = [](sim::Device& it) { miss_left(it, 1.0); },
                          .parameters = {.on_implausible = OnImplausible::report}});
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_EQ(told_of(result, EventKind::counters_implausible).size(), 1U);
}

// Nobody steers: never by the program's own gentle limit.
TEST(InvoluntaryStops, AreHard) {
  const DriveResult broken = [] {
    VirtualDrive drive{sim::Parameters{}};
    drive.on_frame = [&](int frame, ControlCycle&) {
      if (frame == 1500) miss_left(drive.device, 1.0);
    };
    return drive.run(2000, forward, gently());
  }();
  EXPECT_EQ(broken.end, CycleEnd::implausible);
  expect_hard_stop(broken);

  VirtualDrive silent{sim::Parameters{}};
  silent.on_frame = [&](int frame, ControlCycle&) {
    if (frame == 1500) silent.device.faults().stalled_until = silent.device.now() + 20 * oi::kTick;
  };
  const DriveResult heard = silent.run(1600, forward, gently());
  ASSERT_EQ(told_of(heard, EventKind::silence_began).size(), 1U);
  const auto stop = std::ranges::adjacent_find(
      heard.commands, [](const sim::DriveRecord& former, const sim::DriveRecord& next) {
        return former.command.left_mm_s > 150.0 && next.command == sim::WheelSpeeds{};
      });
  EXPECT_NE(stop, heard.commands.end()) << "from full speed to 0 in one command";
}

TEST(Limits, OfSpeedKeepTheCurveAndAreReported) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    VirtualDrive drive{sim::Parameters{.remainder = remainder}};
    const DriveResult result = drive.run(600, [](double seconds) {
      return seconds < 6.0 ? rt::WheelSpeeds{300.0, 500.0} : rt::WheelSpeeds{120.0, 200.0};
    });
    const auto began = told_of(result, EventKind::limit_began);
    ASSERT_EQ(began.size(), 1U);
    EXPECT_TRUE(began[0].limits.has(Limit::speed));
    EXPECT_EQ(began[0].wanted, (rt::WheelSpeeds{300.0, 500.0}));
    EXPECT_EQ(told_of(result, EventKind::limit_ended).size(), 1U);
    double left = 0.0;
    double right = 0.0;
    for (const test::Tick& tick : result.ticks) {
      if (tick.state.tick < 200 || tick.state.tick > 380) continue;
      EXPECT_TRUE(tick.state.limits.has(Limit::speed));
      left += tick.truth.left_mm_s;
      right += tick.truth.right_mm_s;
    }
    EXPECT_NEAR((right - left) / (right + left), 0.25, 0.005) << "2 % of the curvature";
    EXPECT_FALSE(result.ticks.back().state.limits.any());
  }
}

TEST(Limits, OfAccelerationAreABitAndAnEventIfTheyLast) {
  VirtualDrive drive{sim::Parameters{}};
  CycleParameters parameters;
  parameters.loop.limits.acceleration_mm_s2 = 100.0;
  const DriveResult result = drive.run(400, forward, parameters);
  const auto began = told_of(result, EventKind::limit_began);
  ASSERT_EQ(began.size(), 1U);
  EXPECT_TRUE(began[0].limits.has(Limit::acceleration));
  EXPECT_EQ(told_of(result, EventKind::limit_ended).size(), 1U);
  EXPECT_TRUE(result.ticks[30].state.limits.has(Limit::acceleration));
  EXPECT_FALSE(result.ticks.back().state.limits.any());
}

}  // namespace
}  // namespace cargobay::hal
