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
    const FrameList list = rotation.next(Counters::wanted);
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
    ++frames[rotation.next(tick % 40 == 0 ? Counters::wanted : Counters::not_wanted)];
  }
  EXPECT_EQ(frames[FrameList::reading], 100);
  EXPECT_NEAR(frames[FrameList::battery], 4000.0 / FrameRotation::kBatteryTicks, 2);
}

// Including DriveDirect and the longest list after it, at the robot's slowest.
TEST(FrameLists, AreAnsweredWithinATickAt19200Baud) {
  const auto answer = oi::kDriveDirectBytes + 2 + oi::kCreate.list(oi::FrameList::reading).size();
  EXPECT_LT(oi::wire_time(oi::kCreate.frame_bytes + answer, oi::kCreate.brc_baud), oi::kTick);
}

}  // namespace
}  // namespace cargobay::hal
