#include "rt/read_schedule.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using Motion = ReadSchedule::Motion;

// `count` ticks as a picture: R reads the counters, a dot does not.
std::string ticks(ReadSchedule& schedule, int count, RemainderBelief belief, Motion motion) {
  std::string picture;
  for (int i = 0; i < count; ++i) picture += schedule.next_reads(belief, motion) ? 'R' : '.';
  return picture;
}
std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}
std::string window(int length) {
  return std::string(static_cast<std::size_t>(length - 1), '.') + 'R';
}
std::string reads(int count) { return std::string(static_cast<std::size_t>(count), 'R'); }

constexpr auto kUnknown = RemainderBelief::unknown;
constexpr auto kCarried = RemainderBelief::carried;
constexpr auto kLost = RemainderBelief::lost;

TEST(ReadSchedule, ReadsEveryTickAtRest) {
  for (const auto belief : {kUnknown, kCarried, kLost}) {
    ReadSchedule schedule{{}};
    EXPECT_EQ(ticks(schedule, 500, belief, Motion::none), reads(500));
  }
}

TEST(ReadSchedule, DoesBothInTurnWhileTheKindIsNotKnown) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 3 * 22, kUnknown, Motion::steady), repeated(reads(12) + window(10), 3));
}

TEST(ReadSchedule, BeginsAnewWithEachMotion) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 17, kUnknown, Motion::steady), reads(12) + ".....");
  EXPECT_EQ(ticks(schedule, 3, kUnknown, Motion::none), reads(3));
  EXPECT_EQ(ticks(schedule, 22, kUnknown, Motion::steady), reads(12) + window(10));
}

TEST(ReadSchedule, ReadsEveryTickWhereTheRemainderIsCarried) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 199, kCarried, Motion::steady), reads(199));
}

TEST(ReadSchedule, TriesNowAndThenWhetherItIsStillCarried) {
  ReadSchedule schedule{{}};
  const std::string period = reads(199) + reads(12) + window(10) + 'R';
  EXPECT_EQ(ticks(schedule, 222 * 3, kCarried, Motion::steady), repeated(period, 3));
}

TEST(ReadSchedule, WidensTheWindowOnceTheSpeedIsSteady) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 130, kLost, Motion::steady), window(10) + repeated(window(40), 3));
}

TEST(ReadSchedule, ReadsSoonAfterAChangeOfSpeed) {
  ReadSchedule schedule{{}};
  (void)ticks(schedule, 50 + 25, kLost, Motion::steady);
  EXPECT_EQ(ticks(schedule, 11, kLost, Motion::changing), "R" + window(10))
      << "what was travelled before the change is read at once";
  EXPECT_EQ(ticks(schedule, 50, kLost, Motion::steady), window(10) + window(40));
}

TEST(ReadSchedule, KeepsWindowsShortWhileTheSpeedChanges) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 200, kLost, Motion::changing), repeated(window(10), 20));
}

TEST(ReadSchedule, SeldomTriesWhetherItIsStillLost) {
  ReadSchedule schedule{{}};
  const std::string picture = ticks(schedule, 10'220, kLost, Motion::steady);
  int rows = 0;
  for (std::size_t at = picture.find(reads(12)); at != std::string::npos;
       at = picture.find(reads(12), at + 12)) {
    ++rows;
  }
  EXPECT_EQ(rows, 10);
  EXPECT_LE(std::count(picture.begin(), picture.end(), 'R'), 10 * (1022 / 40 + 12 + 3));
}

TEST(ReadSchedule, TakesItsLengthsFromItsParameters) {
  ReadSchedule schedule{{.probe_window_ticks = 3, .probe_reads = 2}};
  EXPECT_EQ(ticks(schedule, 10, kUnknown, Motion::steady), "RR..RRR..R");
}

}  // namespace
}  // namespace cargobay::rt
