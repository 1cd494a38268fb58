// What other threads can ask of a running cycle.
#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "hal/cycle/request.hpp"
#include "tests/hal/command_request.hpp"
#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::command;
using test::DriveResult;
using test::VirtualDrive;

// A script of 100 bytes: 25 times the LEDs.
Request script(Request::WhenLong when_long) {
  Request request;
  request.when_long = when_long;
  request.bytes[0] = 152;
  request.bytes[1] = 100;
  for (std::size_t i = 0; i < 100; i += 4) {
    request.bytes[2 + i] = 139;
    request.bytes[3 + i] = 8;
  }
  request.size = 102;
  return request;
}

rt::WheelSpeeds ahead(double /*seconds*/) { return {200.0, 200.0}; }
rt::WheelSpeeds nowhere(double /*seconds*/) { return {}; }

TEST(Requests, AreObeyedBesideTheDrive) {
  VirtualDrive drive{{}};
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 100) {
      EXPECT_TRUE(cycle.request(command({139, 2, 77, 200})));
    }
    if (frame == 101) {
      EXPECT_TRUE(cycle.request(command({147, 5})));
    }
  };
  const DriveResult result = drive.run(200, ahead);
  EXPECT_EQ(result.frames.good, 200U);
  EXPECT_EQ(drive.device.counters().unknown_opcodes, 0U);
  EXPECT_EQ(drive.device.actuators().leds.power_color, 77);
  EXPECT_EQ(drive.device.actuators().digital_outputs, 5);
  // Not one drive command was left out because of them.
  EXPECT_GE(result.commands.size(), 200U);
}

TEST(Requests, GoOutOneAFrame) {
  VirtualDrive drive{{}};
  std::map<int, std::uint64_t> obeyed;
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 100) {
      for (std::uint8_t i = 0; i < 10; ++i) EXPECT_TRUE(cycle.request(command({151, i})));
    }
    obeyed[frame] = drive.device.counters().commands;
  };
  (void)drive.run(200, nowhere);
  for (int frame = 101; frame < 112; ++frame)
    EXPECT_LE(obeyed[frame + 1] - obeyed[frame], 3U) << "drive, list, request";
}

TEST(Requests, WaitWithALongOneUntilTheWheelsStand) {
  VirtualDrive drive{{}};
  std::size_t while_driving = 0;
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 50) {
      EXPECT_TRUE(cycle.request(script(Request::WhenLong::wait)));
    }
    if (frame == 190) while_driving = drive.device.script().size();
  };
  const DriveResult result = drive.run(400, [](double seconds) {
    return seconds < 3.0 ? rt::WheelSpeeds{200.0, 200.0} : rt::WheelSpeeds{};
  });
  EXPECT_EQ(while_driving, 0U);
  EXPECT_EQ(drive.device.script().size(), 100U);
  EXPECT_EQ(result.frames.good, 400U);
}

// The wheels keep turning as last told, and afterwards no two commands share a tick.
TEST(Requests, PauseTheDriveWhereTheyAreToldTo) {
  VirtualDrive drive{{}};
  std::uint64_t withheld = 0;
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 100) {
      EXPECT_TRUE(cycle.request(script(Request::WhenLong::pause)));
    }
    withheld = cycle.counters().withheld;
  };
  const DriveResult result = drive.run(200, ahead);
  EXPECT_EQ(drive.device.script().size(), 100U);
  EXPECT_GE(withheld, 1U);
  EXPECT_LE(withheld, 3U);
  EXPECT_EQ(result.frames.good, 200U);
}

TEST(Requests, AreDroppedWhereTheModeDoesNotAllowThem) {
  VirtualDrive drive{{}};
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame < 50) return;
    drive.device.inputs().wheel_drop_left = true;
    EXPECT_TRUE(cycle.request(command({139, 2, 77, 200})));
  };
  const DriveResult result = drive.run(200, ahead);
  EXPECT_EQ(result.end, CycleEnd::mode_lost);
  EXPECT_EQ(drive.device.actuators().leds.power_color, 0);
  EXPECT_LE(drive.device.counters().commands_refused, 1U) << "the drive command of that tick";
}

TEST(Requests, StreamWhatIsAskedFor) {
  VirtualDrive drive{{}};
  std::optional<SensorReadings> before;
  std::optional<SensorReadings> after;
  std::int64_t tick = 0;
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    drive.device.inputs().analog = 555;
    if (frame == 400) before = cycle.sensors();
    if (frame == 400) {
      EXPECT_TRUE(cycle.request({.kind = Request::Kind::stream, .extras = kAllExtraLists}));
    }
    if (frame == 600) after = cycle.sensors();
    if (frame == 600) tick = cycle.state()->tick;
  };
  const DriveResult result = drive.run(700, ahead);
  EXPECT_EQ(result.frames.good, 700U);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(before->tick[33], SensorReadings::kNever);
  EXPECT_EQ(after->value[33], 555);
  for (const std::size_t packet : {27U, 28U, 29U, 30U, 31U, 32U, 33U, 36U, 42U})
    EXPECT_GT(after->tick[packet], tick - 20) << packet;
  for (const std::size_t packet : {7U, 9U, 14U, 18U, 34U, 35U})
    EXPECT_GT(after->tick[packet], tick - 20) << packet << ": the loop's own lists go on";
}

// The estimate is hardly worse for it, with either kind of robot.
TEST(Requests, LeaveTheLoopWhatItNeeds) {
  for (const auto kind : {sim::Remainder::carried, sim::Remainder::lost}) {
    VirtualDrive drive{{.remainder = kind}};
    drive.on_frame = [&](int frame, ControlCycle& cycle) {
      if (frame == 1) {
        EXPECT_TRUE(cycle.request({.kind = Request::Kind::stream, .extras = kAllExtraLists}));
      }
    };
    const DriveResult result = drive.run(1400, ahead);
    double sum = 0.0;
    int count = 0;
    for (const test::Tick& tick : result.ticks) {
      if (tick.state.tick < 400) continue;
      const double error = tick.state.estimate.left_mm_s - tick.truth.left_mm_s;
      sum += error * error;
      ++count;
    }
    EXPECT_LE(std::sqrt(sum / count), kind == sim::Remainder::carried ? 4.0 : 6.0);
  }
}

TEST(Requests, PutTheOdometrySomewhere) {
  VirtualDrive drive{{}};
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 100) {
      EXPECT_TRUE(cycle.request({.kind = Request::Kind::pose, .pose = {1000.0, 2000.0, 0.5}}));
    }
  };
  const DriveResult result = drive.run(110, nowhere);
  const CycleState& last = result.ticks.back().state;
  EXPECT_NEAR(last.pose.x_mm, 1000.0, 1.0);
  EXPECT_NEAR(last.pose.y_mm, 2000.0, 1.0);
  EXPECT_NEAR(last.pose.heading_rad, 0.5, 0.02);
}

TEST(Requests, AreRefusedWhereTooManyWait) {
  VirtualDrive drive{{}};
  int taken = 0;
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame != 10) return;
    for (std::uint8_t i = 0; i < 40; ++i) taken += cycle.request(command({151, i})) ? 1 : 0;
  };
  (void)drive.run(100, nowhere);
  EXPECT_EQ(taken, static_cast<int>(kMostRequests));
}

}  // namespace
}  // namespace cargobay::hal
