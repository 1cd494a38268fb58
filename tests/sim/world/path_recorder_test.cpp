#include "hal/sim/world/path_recorder.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace cargobay::hal::sim {
namespace {

// A spiral outward, from the origin, a millimetre at a time.
WorldPose on_spiral(int i) {
  const double angle_rad = std::sqrt(0.02 * i);
  return {50.0 * angle_rad * std::cos(angle_rad), 50.0 * angle_rad * std::sin(angle_rad),
          angle_rad};
}

TEST(PathRecorder, IsEmptyAtFirst) { EXPECT_TRUE(PathRecorder{}.path().empty()); }

TEST(PathRecorder, KeepsBothEnds) {
  PathRecorder recorder;
  recorder.add({1.0, 2.0, 0.0}, false);
  recorder.add({1.0, 2.5, 0.3}, false);
  const auto path = recorder.path();
  ASSERT_EQ(path.size(), 2U);
  EXPECT_EQ(path[0].pose.y_mm, 2.0);
  EXPECT_EQ(path[1].pose.y_mm, 2.5);
  EXPECT_EQ(path[1].pose.heading_rad, 0.3);
}

TEST(PathRecorder, TellsTheLastHeadingOfARobotThatOnlyTurns) {
  PathRecorder recorder;
  recorder.add({1.0, 2.0, 0.0}, false);
  recorder.add({1.0, 2.0, 1.0}, false);
  ASSERT_EQ(recorder.path().size(), 1U);
  EXPECT_EQ(recorder.path().back().pose.heading_rad, 1.0);
}

// However long the way and however little room: beginning, end and everything between are kept.
TEST(PathRecorder, ThinsOutAllOfALongPathAlike) {
  for (const std::size_t most : {4U, 5U, 64U, 1000U}) {
    PathRecorder recorder{most};
    constexpr int kTicks = 200'000;
    for (int i = 0; i < kTicks; ++i) recorder.add(on_spiral(i), false);
    const auto path = recorder.path();
    EXPECT_LE(path.size(), most + 1);
    EXPECT_GE(path.size(), most / 2);
    EXPECT_EQ(path.front().pose.x_mm, 0.0);
    EXPECT_EQ(path.back().pose.x_mm, on_spiral(kTicks - 1).x_mm);
    double longest_mm = 0.0;
    double length_mm = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const double step_mm = std::hypot(path[i].pose.x_mm - path[i - 1].pose.x_mm,
                                        path[i].pose.y_mm - path[i - 1].pose.y_mm);
      longest_mm = std::max(longest_mm, step_mm);
      length_mm += step_mm;
    }
    // Four points do not make a spiral.
    if (most < 64) continue;
    EXPECT_LT(longest_mm, 5.0 * length_mm / static_cast<double>(path.size()));
  }
}

TEST(PathRecorder, MarksTheFirstOfABump) {
  PathRecorder recorder;
  for (int i = 0; i < 20; ++i) recorder.add({0.1 * i, 0.0, 0.0}, i >= 5 && i < 10);
  const auto path = recorder.path();
  ASSERT_EQ(path.size(), 3U);
  EXPECT_TRUE(path[1].bumped);
  EXPECT_DOUBLE_EQ(path[1].pose.x_mm, 0.5);
  EXPECT_FALSE(path[2].bumped);
}

TEST(PathRecorder, TellsALeapFromDriving) {
  PathRecorder recorder;
  recorder.add({0.0, 0.0, 0.0}, false);
  recorder.add({3.0, 0.0, 0.0}, false);
  recorder.add({1000.0, 0.0, 0.0}, false);
  recorder.add({1003.0, 0.0, 0.0}, false);
  const auto path = recorder.path();
  ASSERT_EQ(path.size(), 4U);
  EXPECT_EQ(path[1].pose.x_mm, 3.0) << "where it leapt from";
  EXPECT_FALSE(path[1].placed);
  EXPECT_TRUE(path[2].placed);
  EXPECT_FALSE(path[3].placed);
}

TEST(PathRecorder, KeepsMarksWhereItThinsOut) {
  PathRecorder recorder{16};
  bool bumped = false;
  bool placed = false;
  for (int i = 0; i < 10'000; ++i) {
    recorder.add({10.0 * i + (i > 333 ? 5000.0 : 0.0), 0.0, 0.0}, i == 21);
  }
  for (const Waypoint& waypoint : recorder.path()) {
    bumped = bumped || waypoint.bumped;
    placed = placed || waypoint.placed;
  }
  EXPECT_TRUE(bumped);
  EXPECT_TRUE(placed);
}

TEST(PathRecorder, StaysSmallWhereARobotIsPutAboutForEver) {
  PathRecorder recorder{32};
  for (int i = 0; i < 10'000; ++i) recorder.add({i % 2 == 0 ? 0.0 : 900.0, 0.0, 0.0}, i % 3 == 0);
  EXPECT_LE(recorder.path().size(), 33U);
}

}  // namespace
}  // namespace cargobay::hal::sim
