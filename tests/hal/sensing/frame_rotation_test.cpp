#include "hal/sensing/frame_rotation.hpp"

#include <map>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"

namespace cargobay::hal {
namespace {

using Counters = FrameRotation::Counters;

TEST(FrameRotation, GoesWithoutAReadingNowAndThen) {
  FrameRotation rotation;
  std::map<FrameList, int> frames;
  int in_a_row = 0;
  for (int tick = 0; tick < 1600; ++tick) {
    const FrameList list = rotation.next(Counters::wanted, rt::kBothAxes);
    ++frames[list];
    in_a_row = list == FrameList::reading ? in_a_row + 1 : 0;
    EXPECT_LE(in_a_row, FrameRotation::kMostReadingsInARow);
  }
  EXPECT_EQ(frames[FrameList::reading], 1500);
  EXPECT_EQ(frames[FrameList::battery], 25);
  EXPECT_EQ(frames[FrameList::hazards], 75);
}

TEST(FrameRotation, TellsOfHazardsBetweenReadings) {
  FrameRotation rotation;
  std::map<FrameList, int> frames;
  for (int tick = 0; tick < 4000; ++tick) {
    ++frames[rotation.next(tick % 40 == 0 ? Counters::wanted : Counters::not_wanted,
                           rt::kBothAxes)];
  }
  EXPECT_EQ(frames[FrameList::reading], 100);
  EXPECT_NEAR(frames[FrameList::battery], 4000.0 / FrameRotation::kBatteryTicks, 2);
}

// Infrared byte and buttons in turn: no list of five packets has room for both.
TEST(FrameRotation, ReadsOnlyTheCounterThatIsMeant) {
  FrameRotation rotation;
  constexpr rt::Axes kDistance{.distance = true};
  EXPECT_EQ(rotation.next(Counters::wanted, kDistance), FrameList::distance_buttons);
  EXPECT_EQ(rotation.next(Counters::wanted, kDistance), FrameList::distance);
  EXPECT_EQ(rotation.next(Counters::wanted, kDistance), FrameList::distance_buttons);
  EXPECT_EQ(rotation.next(Counters::wanted, {.turn = true}), FrameList::angle);
  EXPECT_EQ(rotation.next(Counters::wanted, rt::kBothAxes), FrameList::reading);
}

TEST(FrameLists, SayWhichCountersTheyRead) {
  for (std::size_t i = 0; i < oi::kFrameLists; ++i) {
    const auto list = static_cast<FrameList>(i);
    const std::uint64_t packets = oi::kCreate.listed[i];
    const auto has = [packets](oi::PacketId id) {
      return (packets & oi::packet_bits(oi::kCreate.packet(id))) != 0;
    };
    EXPECT_EQ(axes_of(list), (rt::Axes{.distance = has(oi::PacketId::distance),
                                       .turn = has(oi::PacketId::angle)}));
  }
}

// Including DriveDirect and the longest list after it, at the robot's slowest.
TEST(FrameLists, AreAnsweredWithinATickAt19200Baud) {
  const auto answer = oi::kDriveDirectBytes + 2 + oi::kMostListed;
  EXPECT_LT(oi::wire_time(oi::kCreate.frame_bytes + answer, oi::kCreate.brc_baud), oi::kTick);
}

}  // namespace
}  // namespace cargobay::hal
