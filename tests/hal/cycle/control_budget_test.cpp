// Control functions that take too long, in virtual time: their time passes on the robot too.

#include <chrono>
#include <map>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;
using test::DriveResult;
using test::forward;
using test::VirtualDrive;

int most_commands_in_a_tick(const DriveResult& result) {
  std::map<std::uint64_t, int> in_tick;
  int most = 0;
  // Without the stops of the cycle and of farewell().
  for (std::size_t i = 0; i + 2 < result.commands.size(); ++i) {
    most = std::max(most, ++in_tick[result.commands[i].tick]);
  }
  return most;
}

TEST(ControlBudget, MayBeUsedUp) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int, ControlCycle&) { drive.link.advance(2ms); };
  const DriveResult result = drive.run(300, forward);
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_EQ(result.overruns.user, 0U);
}

TEST(ControlBudget, CountsWhatIsOverIt) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int frame, ControlCycle&) {
    if (frame % 20 < 10) drive.link.advance(2ms + 1us);  // ten in a row
  };
  const DriveResult result = drive.run(400, forward);
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_EQ(result.overruns.user, 200U);
  EXPECT_EQ(result.overruns.read + result.overruns.write + result.overruns.wait, 0U);
  EXPECT_NEAR(result.ticks.back().state.estimate.left_mm_s, 200.0, 10.0);
}

TEST(ControlBudget, EndsTheCycleOneBeyondThoseAllowed) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int frame, ControlCycle&) {
    if (frame >= 100) drive.link.advance(3ms);
  };
  const DriveResult result = drive.run(400, forward);
  EXPECT_EQ(result.end, CycleEnd::control_overrun);
  EXPECT_EQ(result.overruns.user, 11U);
  EXPECT_EQ(result.ticks.size(), 110U);
  EXPECT_EQ(drive.device.commanded(), rt::WheelSpeeds{});
  EXPECT_EQ(drive.device.mode(), oi::Mode::passive);
}

TEST(ControlBudget, IsAParameter) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int, ControlCycle&) { drive.link.advance(5ms); };
  const DriveResult result =
      drive.run(100, forward, {.control_budget = 4ms, .control_overruns_allowed = 0});
  EXPECT_EQ(result.end, CycleEnd::control_overrun);
  EXPECT_EQ(result.overruns.user, 1U);
}

// Longer than a tick: frames pile up meanwhile, and are answered once.
TEST(ControlBudget, OverrunByTicksBringsNoBurst) {
  for (rt::Duration stall = 5ms; stall < 120ms; stall += 3ms) {
    VirtualDrive drive{sim::Parameters{}};
    drive.on_frame = [&](int frame, ControlCycle&) {
      if (frame % 50 == 49) drive.link.advance(stall);
    };
    const DriveResult result = drive.run(300, forward);
    EXPECT_EQ(result.end, CycleEnd::asked);
    EXPECT_LE(most_commands_in_a_tick(result), 1) << stall.count();
    EXPECT_EQ(result.overruns.user, 6U) << stall.count();
    if (stall > 20ms) {
      EXPECT_GE(result.overruns.wait, 5U) << stall.count();
    }
  }
}

}  // namespace
}  // namespace cargobay::hal
