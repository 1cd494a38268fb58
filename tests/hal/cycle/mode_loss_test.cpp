// A robot that leaves its mode by itself: the cause is reported once, and it returns only on
// request.

#include <array>
#include <functional>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using test::DriveResult;
using test::forward;
using test::VirtualDrive;

struct Danger {
  Hazard hazard;
  std::function<void(sim::Inputs&, bool)> set;
};

std::ostream& operator<<(std::ostream& out, const Danger& danger) {
  return out << name(danger.hazard);
}

std::vector<Danger> all_dangers() {
  using sim::Inputs;
  return {
      {Hazard::wheel_drop_left, [](Inputs& in, bool on) { in.wheel_drop_left = on; }},
      {Hazard::wheel_drop_right, [](Inputs& in, bool on) { in.wheel_drop_right = on; }},
      {Hazard::wheel_drop_front, [](Inputs& in, bool on) { in.wheel_drop_caster = on; }},
      {Hazard::cliff_left, [](Inputs& in, bool on) { in.cliff_left.cliff = on; }},
      {Hazard::cliff_front_left, [](Inputs& in, bool on) { in.cliff_front_left.cliff = on; }},
      {Hazard::cliff_front_right, [](Inputs& in, bool on) { in.cliff_front_right.cliff = on; }},
      {Hazard::cliff_right, [](Inputs& in, bool on) { in.cliff_right.cliff = on; }},
      {Hazard::charger, [](Inputs& in, bool on) { in.charger = on; }},
  };
}

std::vector<Event> of_kind(const DriveResult& result, EventKind what) {
  std::vector<Event> events;
  for (const Event& event : result.events) {
    if (event.what == what) events.push_back(event);
  }
  return events;
}

class ModeLoss : public testing::TestWithParam<Danger> {};

// Whichever list the frame that shows the mode has: at every phase of the rotation.
TEST_P(ModeLoss, IsToldOnceWithItsCause) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    for (int begin = 200; begin < 220; ++begin) {
      VirtualDrive drive{sim::Parameters{.remainder = remainder}};
      drive.on_frame = [&](int frame, ControlCycle&) {
        if (frame == begin) GetParam().set(drive.device.inputs(), true);
      };
      const DriveResult result = drive.run(400, forward);
      EXPECT_EQ(result.end, CycleEnd::mode_lost);
      const auto losses = of_kind(result, EventKind::mode_lost);
      ASSERT_EQ(losses.size(), 1U);
      EXPECT_EQ(losses[0].hazards, Hazards{}.with(GetParam().hazard)) << begin;
      EXPECT_EQ(losses[0].mode, oi::Mode::passive);
      EXPECT_NEAR(static_cast<double>(losses[0].tick), begin + 1.0, 2.0);
      EXPECT_EQ(result.causes, losses[0].hazards);
      EXPECT_TRUE(result.confirmed_passive);
    }
  }
}

TEST_P(ModeLoss, HoldsUntilItIsAskedToRearm) {
  VirtualDrive drive{sim::Parameters{}};
  ControlCycle* cycle = nullptr;
  std::uint64_t refused = 1;
  rt::WheelSpeeds driven{};
  // A cliff does not matter to a robot that stands still (OI p. 6).
  const bool stops_standing =
      GetParam().hazard < Hazard::cliff_left || GetParam().hazard == Hazard::charger;
  int frames = 0;
  drive.on_frame = [&](int frame, ControlCycle& it) {
    cycle = &it;
    if (frame == 100) GetParam().set(drive.device.inputs(), true);
    driven = drive.device.truth().speeds;
  };
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    if (cycle == nullptr) return bytes.size();  // bring-up
    ++frames;
    if (frames == 600) refused = drive.device.counters().commands_refused;
    if (frames == 150 && stops_standing) cycle->request_rearm();  // the danger is still there
    if (frames == 300) GetParam().set(drive.device.inputs(), false);
    if (frames > 110 && frames <= 600) {
      EXPECT_EQ(drive.device.mode(), oi::Mode::passive) << frames;
      EXPECT_EQ(drive.device.commanded(), rt::WheelSpeeds{}) << frames;
    }
    if (frames == 600) cycle->request_rearm();
    return bytes.size();
  };
  const DriveResult result = drive.run(400, forward, {.on_mode_loss = OnModeLoss::hold});
  EXPECT_EQ(result.end, CycleEnd::asked);
  EXPECT_EQ(of_kind(result, EventKind::mode_lost).size(), 1U);
  const auto refusals = of_kind(result, EventKind::rearm_failed);
  ASSERT_EQ(refusals.size(), stops_standing ? 1U : 0U);
  for (const Event& refusal : refusals) {
    EXPECT_EQ(refusal.hazards, Hazards{}.with(GetParam().hazard));
  }
  const auto rearmed = of_kind(result, EventKind::rearmed);
  ASSERT_EQ(rearmed.size(), 1U);
  EXPECT_EQ(rearmed[0].mode, oi::Mode::safe);
  EXPECT_EQ(refused, 0U) << "no wheel command to a robot that does not obey";
  EXPECT_NEAR(driven.left_mm_s, 200.0, 10.0);
}

INSTANTIATE_TEST_SUITE_P(All, ModeLoss, testing::ValuesIn(all_dangers()),
                         testing::PrintToStringParamName());

TEST(ModeLossCause, IsNoneWhereNoSensorSays) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int frame, ControlCycle&) {
    constexpr std::array<std::uint8_t, 1> kStart{128};  // another program's: Passive
    if (frame == 100) (void)drive.link.write(kStart);
  };
  const DriveResult result = drive.run(300, forward);
  EXPECT_EQ(result.end, CycleEnd::mode_lost);
  const auto losses = of_kind(result, EventKind::mode_lost);
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_FALSE(losses[0].hazards.any());
  EXPECT_EQ(describe(losses[0]),
            "the robot went to passive mode by itself, and no sensor says why");
}

// A crack in the floor, narrower than the robot moves in a tick.
TEST(ModeLossCause, IsACliffThatOnlyOneFrameSaw) {
  VirtualDrive drive{sim::Parameters{.remainder = sim::Remainder::lost}};
  drive.device.surroundings = [&](sim::Device& device, sim::Inputs& seen) {
    static constexpr std::uint64_t kTick = 505;  // windows: nearly all frames report hazards
    if (device.ticks() == kTick) seen.cliff_right.cliff = true;
  };
  const DriveResult result = drive.run(1000, forward);
  EXPECT_EQ(result.end, CycleEnd::mode_lost);
  EXPECT_EQ(result.causes, Hazards{}.with(Hazard::cliff_right));
}

TEST(Rearming, NeedsTheModeToBeLost) {
  VirtualDrive drive{sim::Parameters{}};
  drive.on_frame = [&](int frame, ControlCycle& cycle) {
    if (frame == 50) cycle.request_rearm();
    if (frame == 100) drive.device.inputs().wheel_drop_left = true;
  };
  int frames = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    if (++frames == 130) drive.device.inputs().wheel_drop_left = false;
    return frames < 400 ? bytes.size() : 0;  // ends it
  };
  const DriveResult result = drive.run(1000, forward, {.on_mode_loss = OnModeLoss::hold});
  EXPECT_EQ(result.end, CycleEnd::link_lost);
  EXPECT_TRUE(of_kind(result, EventKind::rearmed).empty());
  EXPECT_EQ(drive.device.mode(), oi::Mode::passive);
}

}  // namespace
}  // namespace cargobay::hal
