// The loop on plants that nobody told it of, whole and broken. tests/campaign/wheel_faults.sh has
// the figures of many more.
#include "rt/wheel_watch.hpp"

#include <cmath>
#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

#include "tests/campaign/plant_drive.hpp"

namespace cargobay::rt {
namespace {

using campaign::any_plant;
using campaign::drive;
using campaign::Driven;
using campaign::How;
using campaign::PlantValues;
using campaign::WheelFault;
using Finding = WheelWatch::Finding;

constexpr Remainder kKinds[] = {Remainder::carried, Remainder::lost};
constexpr std::uint64_t kSeeds = 12;

// Within the range of the weakest of them.
constexpr WheelSpeeds kStraight{180.0, 180.0};
constexpr WheelSpeeds kSpin{-180.0, 180.0};
constexpr WheelSpeeds kArc{110.0, 220.0};

struct Broken {
  WheelFault left{};
  WheelFault right{};
};

// Breaks after 6 s of driving; drives on for as long as it may take.
Driven break_down(const Broken& broken, const WheelSpeeds& speeds, std::uint64_t seed,
                  Remainder kind, double within_s) {
  constexpr double kAtS = 6.0;
  How how{.fault_at_s = kAtS, .left = broken.left, .right = broken.right};
  Driven driven = drive(
      any_plant(seed, kind), seed, kAtS + within_s, [&speeds](double) { return speeds; }, how);
  EXPECT_GE(driven.found_s, kAtS) << "accused before it was broken";
  return driven;
}

void expect_found(Finding what, const Broken& broken, double within_s) {
  for (const Remainder kind : kKinds) {
    for (const WheelSpeeds& speeds : {kStraight, kSpin, kArc}) {
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const WheelWatch::Evidence found =
            break_down(broken, speeds, seed, kind, within_s).evidence;
        const bool left = broken.left.stuck || broken.left.counts != 1.0;
        const bool right = broken.right.stuck || broken.right.counts != 1.0;
        ASSERT_EQ(found.what, what) << seed << ' ' << speeds.left_mm_s;
        EXPECT_EQ(found.wheels.left, left) << seed;
        EXPECT_EQ(found.wheels.right, right) << seed;
        const double driven = left ? found.driven.left_mm_s : found.driven.right_mm_s;
        const double counted = left ? found.counted.left_mm_s : found.counted.right_mm_s;
        EXPECT_GT(driven, 40.0);
        EXPECT_LT(counted, 0.7 * driven);
      }
    }
  }
}

TEST(WheelWatch, TellsADeadCounterWithinASecond) {
  expect_found(Finding::still, {.left = {.counts = 0.0}}, 1.0);
  expect_found(Finding::still, {.left = {.counts = 0.0}, .right = {.counts = 0.0}}, 1.0);
}

TEST(WheelWatch, TellsAStuckWheelWithinASecond) {
  expect_found(Finding::still, {.right = {.stuck = true}}, 1.0);
  expect_found(Finding::still, {.left = {.stuck = true}, .right = {.stuck = true}}, 1.0);
}

TEST(WheelWatch, TellsHalfAnEncoderWithinFiveSeconds) {
  expect_found(Finding::few, {.left = {.counts = 0.5}}, 5.0);
  expect_found(Finding::few, {.right = {.counts = 0.5}}, 5.0);
}

// The loop takes the wheel for one that rolls back, and drives it no more: now and then too little
// is left to tell it from one that stands.
TEST(WheelWatch, TellsACounterThatRunsBackwards) {
  std::uint64_t reversed = 0;
  for (const Remainder kind : kKinds) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Driven driven = break_down({.right = {.counts = -1.0}}, kStraight, seed, kind, 5.0);
      const WheelWatch::Evidence& found = driven.evidence;
      EXPECT_NE(found.what, Finding::nothing) << seed;
      EXPECT_TRUE(found.wheels.right && !found.wheels.left) << seed;
      if (found.what != Finding::reversed) continue;
      EXPECT_LT(found.counted.right_mm_s, 0.0) << seed;
      ++reversed;
    }
  }
  EXPECT_GE(reversed, 2 * kSeeds * 4 / 5);
}

// From the first motion on, nothing being known of the plant yet.
TEST(WheelWatch, TellsADeadCounterAtTheStart) {
  for (const Remainder kind : kKinds) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const How how{.fault_at_s = 0.0, .left = {.counts = 0.0}};
      const Driven driven =
          drive(any_plant(seed, kind), seed, 1.5, [](double) { return kStraight; }, how);
      EXPECT_EQ(driven.evidence.what, Finding::still) << seed;
      EXPECT_TRUE(driven.evidence.wheels.left && !driven.evidence.wheels.right);
    }
  }
}

// Slow, fast, in an arc, with stops, and with a quarter of the gains gone from 5 s on; counters
// with the sign of the command in every third.
TEST(WheelWatch, AccusesNoHealthyRobot) {
  for (const Remainder kind : kKinds) {
    for (std::uint64_t seed = 1; seed <= 2 * kSeeds; ++seed) {
      PlantValues plant = any_plant(seed, kind);
      plant.counts_by_command = seed % 3 == 0;
      const double fast = 20.0 + 10.0 * static_cast<double>(seed);
      const WheelSpeeds speeds{(seed % 4 == 0 ? -1.0 : 0.5) * fast, fast};
      const auto stop_and_go = [&speeds](double time_s) {
        return std::fmod(time_s, 1.5) < 1.0 ? speeds : WheelSpeeds{};
      };
      const auto on_and_on = [&speeds](double) { return speeds; };
      const How how{.load_at_s = 5.0};
      EXPECT_EQ(drive(plant, seed, 15.0, on_and_on, how).evidence.what, Finding::nothing) << seed;
      EXPECT_EQ(drive(plant, seed, 15.0, stop_and_go, how).evidence.what, Finding::nothing) << seed;
    }
  }
}

// Half the gain of one wheel for a moment, as over a threshold, or a wheel that catches.
TEST(WheelWatch, ForgivesAMoment) {
  for (const Remainder kind : kKinds) {
    campaign::PlantRobot robot{{.remainder = kind}, 1};
    WheelLoop loop{{}};
    Axes reads = kBothAxes;
    for (int tick = 0; tick < 2000; ++tick) {
      robot.fail({.stuck = tick % 200 > 189}, {});
      robot.tick(loop.command());
      loop.frame(robot.read(reads));
      loop.control({200.0, 200.0});
      reads = loop.next_reads();
    }
    EXPECT_EQ(loop.evidence().what, Finding::nothing);
  }
}

class Watch {
 public:
  // So many ticks at 200 mm/s; the last of them reads.
  void window(int ticks, int distance_mm) {
    for (int i = 0; i < ticks; ++i) watch_.step({200.0, 200.0}, {});
    watch_.read(
        {.distance_mm = distance_mm, .angle_deg = 0, .distance_ticks = ticks, .turn_ticks = ticks},
        RemainderBelief::carried);
  }
  void impossible(int ticks) {
    for (int i = 0; i < ticks; ++i) watch_.step({200.0, 200.0}, {});
    watch_.read_impossible(kBothAxes);
  }
  WheelWatch& it() { return watch_; }

 private:
  WheelWatch watch_{{}};
};

TEST(WheelWatch, TellsCountersThatJumpAgainAndAgain) {
  Watch watch;
  for (int jump = 0; jump < 2; ++jump) {
    watch.impossible(10);
    watch.window(10, 30);
  }
  EXPECT_EQ(watch.it().evidence().what, Finding::nothing) << "two may be noise";
  watch.impossible(10);
  EXPECT_EQ(watch.it().evidence().what, Finding::jumps);
}

// Also if only one axis is read in between, as of a robot that loses the remainder.
TEST(WheelWatch, TellsJumpsBetweenReadingsOfOneAxis) {
  Watch watch;
  for (int jump = 0; jump < 3; ++jump) {
    watch.impossible(10);
    watch.it().read({.distance_mm = 3}, RemainderBelief::lost);
  }
  EXPECT_EQ(watch.it().evidence().what, Finding::jumps);
}

TEST(WheelWatch, TellsCountersThatJumpOnceASecond) {
  Watch watch;
  int jumps = 0;
  while (watch.it().evidence().what == Finding::nothing && jumps < 20) {
    watch.impossible(10);
    ++jumps;
    for (int i = 0; i < 57; ++i) watch.window(1, 3);
  }
  EXPECT_EQ(watch.it().evidence().what, Finding::jumps);
  EXPECT_LE(jumps, 4);
}

// Junk on the line for a moment is one; what never ends is not.
TEST(WheelWatch, ForgivesAFewReadingsInARow) {
  for (const int ticks : {1, 5, 12}) {
    Watch watch;
    for (int i = 0; i < 4; ++i) watch.impossible(ticks);
    EXPECT_EQ(watch.it().evidence().what, Finding::nothing) << ticks;
    for (int i = 0; i < 3; ++i) watch.impossible(ticks);
    EXPECT_EQ(watch.it().evidence().what, Finding::jumps) << ticks;
  }
}

TEST(WheelWatch, ForgetsAJumpInTime) {
  Watch watch;
  for (int i = 0; i < 20; ++i) {  // one in 6 s
    watch.impossible(390);
    watch.window(10, 30);
  }
  EXPECT_EQ(watch.it().evidence().what, Finding::nothing);
}

// A robot that loses the remainder reads 0 in each single tick below 67 mm/s, and may be taken for
// one that carries it: only a window can accuse it.
TEST(WheelWatch, TrustsNoSingleTicksThatSayZero) {
  Watch watch;
  for (int i = 0; i < 200; ++i) watch.window(1, 0);
  EXPECT_EQ(watch.it().evidence().what, Finding::nothing);
  EXPECT_TRUE(watch.it().suspects());
  watch.window(6, 0);
  EXPECT_EQ(watch.it().evidence().what, Finding::nothing) << "it may be one of before";
  watch.window(6, 0);
  EXPECT_EQ(watch.it().evidence().what, Finding::still);
}

// Three readings of the distance and then both, of a robot that loses the remainder and is driven
// straight at 200 mm/s; its left counter is dead, so it says to turn by 20 degrees. Whether
// something was not seen of the distance.
WheelWatch::Finding of_a_dead_counter(bool unseen) {
  WheelWatch watch{{}};
  for (int i = 0; i < 4; ++i) {
    for (int reading = 0; reading < 3; ++reading) {
      for (int tick = 0; tick < 10; ++tick) watch.step({200.0, 200.0}, {});
      WheelWatch::Reading read{.distance_mm = 15, .distance_ticks = 10, .turn_ticks = 30};
      if (reading == 2) read.angle_deg = 20;
      if (unseen && reading == 1)
        watch.read_unseen(read.axes());
      else
        watch.read(read, RemainderBelief::lost);
    }
  }
  return watch.evidence().what;
}

TEST(WheelWatch, SumsCountersThatAreReadApart) {
  EXPECT_EQ(of_a_dead_counter(false), Finding::still);
  EXPECT_EQ(of_a_dead_counter(true), Finding::nothing) << "the distance is not known as a whole";
}

TEST(WheelWatch, DoesNotJudgeWhatItHasNotSeen) {
  Watch watch;
  watch.window(50, 150);
  for (int i = 0; i < 50; ++i) {
    watch.it().step({200.0, 200.0}, {});
    watch.it().read_unseen(kBothAxes);
  }
  watch.window(10, 30);
  EXPECT_EQ(watch.it().evidence().what, Finding::nothing);
  EXPECT_FALSE(watch.it().suspects());
}

TEST(WheelWatch, KeepsItsFirstFinding) {
  Watch watch;
  for (int i = 0; i < 20; ++i) watch.window(6, 0);
  ASSERT_EQ(watch.it().evidence().what, Finding::still);
  EXPECT_TRUE(watch.it().evidence().wheels.left && watch.it().evidence().wheels.right);
  for (int i = 0; i < 20; ++i) watch.window(6, 18);
  EXPECT_EQ(watch.it().evidence().what, Finding::still);
}

}  // namespace
}  // namespace cargobay::rt
