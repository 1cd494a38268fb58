#include "hal/sensing/power_watch.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

using Kinds = std::vector<EventKind>;

class Battery : public testing::Test {
 protected:
  void read(std::int32_t voltage_mv, std::int32_t charge_mah, int times = PowerWatch::kReadings,
            oi::ChargingState charging = oi::ChargingState::not_charging) {
    for (int i = 0; i < times; ++i) {
      oi::SensorValues frame;
      frame.set(oi::PacketId::voltage, voltage_mv);
      frame.set(oi::PacketId::battery_charge, charge_mah);
      frame.set(oi::PacketId::battery_capacity, capacity_mah_);
      frame.set(oi::PacketId::charging_state, static_cast<std::int32_t>(charging));
      for (const Event& event : watch_.see(frame)) told_.push_back(event.what);
    }
  }

  PowerWatch watch_{PowerWatch::Limits{}};
  std::int32_t capacity_mah_ = 2000;
  Kinds told_;
};

TEST_F(Battery, IsToldLowOnceByItsCharge) {
  read(15'000, 201, 10);
  EXPECT_TRUE(told_.empty());
  read(15'000, 199, 100);
  EXPECT_EQ(told_, Kinds{EventKind::battery_low});
}

TEST_F(Battery, IsToldLowOnceByItsVoltage) {
  read(13'200, 1500, 10);
  EXPECT_TRUE(told_.empty());
  read(13'199, 1500, 100);
  EXPECT_EQ(told_, Kinds{EventKind::battery_low});
}

TEST_F(Battery, MayDropForAMoment) {
  for (int start = 0; start < 50; ++start) {
    read(12'000, 1500, PowerWatch::kReadings - 1);
    read(15'000, 1500, 1);
  }
  EXPECT_TRUE(told_.empty());
}

TEST_F(Battery, RecoversOnlyBeyondTheHysteresis) {
  read(13'100, 190);
  for (int i = 0; i < 50; ++i) read(13'100 + i * 14, 190 + i * 2);  // to 13.79 V, 288 mAh
  EXPECT_EQ(told_, Kinds{EventKind::battery_low});
  read(14'000, 299, 10);
  read(13'800, 310, 10);
  EXPECT_EQ(told_, Kinds{EventKind::battery_low});
  read(13'801, 300);
  EXPECT_EQ(told_, (Kinds{EventKind::battery_low, EventKind::battery_recovered}));
  read(15'000, 199);
  EXPECT_EQ(told_.size(), 3U);
}

TEST_F(Battery, OfNoKnownCapacityIsJudgedByItsVoltage) {
  capacity_mah_ = 0;
  read(15'000, 0, 10);
  EXPECT_TRUE(told_.empty());
  read(13'000, 0);
  read(14'000, 0);
  EXPECT_EQ(told_, (Kinds{EventKind::battery_low, EventKind::battery_recovered}));
}

TEST_F(Battery, IsToldChargedAndNoLonger) {
  using oi::ChargingState;
  for (const auto state : {ChargingState::reconditioning, ChargingState::full,
                           ChargingState::trickle, ChargingState::waiting, ChargingState::fault}) {
    read(15'000, 1500, 5, state);
  }
  EXPECT_EQ(told_, (Kinds{EventKind::charging_began, EventKind::charging_ended}));
}

TEST(Overcurrent, IsToldOnceForEachThatBegins) {
  using oi::Overcurrent;
  const auto left = oi::BitSet<Overcurrent>{}.with(Overcurrent::left_wheel);
  const auto both = left.with(Overcurrent::low_side_driver_0);
  PowerWatch watch{PowerWatch::Limits{}};
  std::vector<Event> told;
  for (const auto now : {left, left, both, left, {}, {}, left}) {
    oi::SensorValues frame;
    frame.set(oi::PacketId::overcurrents, now.raw());
    for (const Event& event : watch.see(frame)) told.push_back(event);
  }
  ASSERT_EQ(told.size(), 4U);
  EXPECT_EQ(told[0].overcurrents, left);
  EXPECT_EQ(told[1].overcurrents, both.without(Overcurrent::left_wheel));
  EXPECT_EQ(told[2].what, EventKind::overcurrent_ended);
  EXPECT_EQ(told[3].overcurrents, left);
  EXPECT_EQ(describe(told[1]), "low side driver 0 draws too much current");
}

// Through the lists that the loop streams, whether it needs every frame or one in forty.
class PowerOfTheVirtualCreate : public testing::TestWithParam<sim::Remainder> {
 protected:
  static Kinds kinds(const test::DriveResult& result) {
    Kinds kinds;
    for (const Event& event : result.events) kinds.push_back(event.what);
    return kinds;
  }
  test::VirtualDrive drive_{sim::Parameters{.remainder = GetParam()}};
};

TEST_P(PowerOfTheVirtualCreate, NamesTheOvercurrentOfEachWheel) {
  drive_.on_frame = [&](int frame, ControlCycle&) {
    drive_.device.inputs().overcurrent_left_wheel = frame >= 300 && frame < 400;
    drive_.device.inputs().overcurrent_right_wheel = frame >= 500 && frame < 600;
  };
  auto result = drive_.run(700, test::forward, {.on_implausible = OnImplausible::report});
  std::erase_if(result.events, [](const Event& event) {
    return payload(event.what) == Payload::limits || payload(event.what) == Payload::wheels;
  });
  ASSERT_EQ(kinds(result), (Kinds{EventKind::overcurrent_began, EventKind::overcurrent_ended,
                                  EventKind::overcurrent_began, EventKind::overcurrent_ended}));
  EXPECT_TRUE(result.events[0].overcurrents.has(oi::Overcurrent::left_wheel));
  EXPECT_TRUE(result.events[2].overcurrents.has(oi::Overcurrent::right_wheel));
  EXPECT_LE(result.events[0].tick, 300 + 20);
}

TEST_P(PowerOfTheVirtualCreate, TellsOfALowBattery) {
  drive_.device.battery().set_charge_mah(200.0);
  const auto result = drive_.run(1000, test::forward);
  ASSERT_EQ(kinds(result), Kinds{EventKind::battery_low});
  EXPECT_NEAR(result.events[0].battery.charge_mah, 200.0, 5.0);
  EXPECT_LE(result.events[0].tick, 64 * 4);
  EXPECT_NE(describe(result.events[0]).find(" of 2696 mAh"), std::string::npos);
}

TEST_P(PowerOfTheVirtualCreate, TellsOfCharging) {
  int frames = 0;
  ControlCycle* cycle = nullptr;
  drive_.on_frame = [&](int, ControlCycle& it) { cycle = &it; };
  drive_.line.damage = [&](std::span<std::uint8_t> bytes) {
    ++frames;
    drive_.device.inputs().charger = frames >= 300 && frames < 600;
    if (frames == 900) cycle->request_stop();
    return bytes.size();
  };
  const auto result = drive_.run(2000, test::forward, {.on_mode_loss = OnModeLoss::hold});
  EXPECT_EQ(kinds(result),
            (Kinds{EventKind::mode_lost, EventKind::charging_began, EventKind::charging_ended}));
  EXPECT_EQ(result.end, CycleEnd::asked);
}

INSTANTIATE_TEST_SUITE_P(Both, PowerOfTheVirtualCreate,
                         testing::Values(sim::Remainder::carried, sim::Remainder::lost));

}  // namespace
}  // namespace cargobay::hal
