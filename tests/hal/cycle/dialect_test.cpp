// A robot that differs from the Create in what a dialect says, and in nothing else: the loop finds
// it, streams its lists and drives it, and no line of code knows it.
#include "oi/dialect.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal::test {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::uint32_t, 3> kRates{9600, 38400, 57600};
constexpr std::array<std::uint32_t, 1> kLikely{38400};

constexpr oi::FrameLists kLists = [] {
  using enum oi::PacketId;
  constexpr auto list = [](auto... packets) {
    return oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(packets...);
  };
  return oi::FrameLists{
      list(angle, distance, oi_mode, bumps_and_wheel_drops),
      list(oi_mode, cliff_left, cliff_right, overcurrents, bumps_and_wheel_drops),
      list(oi_mode, charging_state, voltage, current),
      list(oi_mode, wall_signal, cliff_left_signal, wall),
      list(oi_mode, cliff_right_signal, analog_signal, digital_inputs),
      list(oi_mode, song_number, requested_velocity, requested_radius),
      list(oi_mode, oi::PacketId::distance, infrared_byte, voltage),
      list(oi_mode, oi::PacketId::distance, buttons, voltage),
      list(oi_mode, oi::PacketId::angle, wall, voltage),
  };
}();

constexpr oi::Dialect kMadeUp =
    oi::complete({.packets = oi::kPackets,
                  .commands = std::span{oi::kCommands}.first(22),  // without scripts
                  .baud_rates = kRates,
                  .likely_rates = kLikely,
                  .default_baud = 38400,
                  .brc_baud = 9600,
                  .wheel_base_mm = 235.0,
                  .distance = oi::PacketId::distance,
                  .angle = oi::PacketId::angle,
                  .frame_lists = kLists});
static_assert(oi::is_consistent(kMadeUp));
static_assert(kMadeUp.frame_bytes != oi::kCreate.frame_bytes);

sim::Parameters robot() {
  sim::Parameters parameters{.boot_baud = 9600, .dialect = &kMadeUp};
  parameters.wheels.wheel_base_mm = kMadeUp.wheel_base_mm;
  return parameters;
}

TEST(Dialect, IsAllThatTheLoopKnowsOfItsRobot) {
  VirtualDrive drive{robot()};
  ASSERT_FALSE(drive.link.set_baud(38400));
  const DriveResult result =
      drive.run(600, [](double) { return rt::WheelSpeeds{150.0, 250.0}; }, defaults_for(kMadeUp));
  ASSERT_TRUE(result.brought_up);
  EXPECT_EQ(drive.link.baud(), 38400U);
  EXPECT_TRUE(result.confirmed_passive);
  EXPECT_GE(result.frames.good, 600U);
  EXPECT_EQ(result.frames.bad + result.frames.lost, 0U);
  ASSERT_GE(result.ticks.size(), 200U);
  double left_mm_s = 0.0;
  double right_mm_s = 0.0;
  for (const Tick& tick : std::span{result.ticks}.last(200)) {
    left_mm_s += tick.truth.left_mm_s / 200.0;
    right_mm_s += tick.truth.right_mm_s / 200.0;
  }
  EXPECT_NEAR(left_mm_s, 150.0, 1.5);
  EXPECT_NEAR(right_mm_s, 250.0, 1.5);
}

TEST(Dialect, GivesTheRobotItsCommands) {
  sim::Device device{robot()};
  const auto tell = [&device](std::initializer_list<std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) device.receive(byte);
  };
  tell({128, 153});  // Play Script is not a command of this robot's
  EXPECT_EQ(device.counters().unknown_opcodes, 1U);
  tell({129, 1});
  device.advance(200ms);
  EXPECT_EQ(device.baud(), 38400U);
}

}  // namespace
}  // namespace cargobay::hal::test
