#include "rt/tick_clock.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""ns;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""us;

constexpr Duration kTickPeriod = 15ms;
constexpr TimePoint kStart{1000s};

// A robot that sends a frame per tick, and a path to the clock that delays and drops frames.
struct Line {
  Duration tick = kTickPeriod;  // by the host's clock
  // How late the frame of that tick arrives; nothing delays it beyond the next call.
  std::function<Duration(std::int64_t tick)> late = [](std::int64_t) { return Duration{0}; };
  std::function<bool(std::int64_t tick)> drops = [](std::int64_t) { return false; };
};

struct Counted {
  std::int64_t lost = 0;
  std::int64_t ticks = 0;
  // expected() compared with the due time of the next frame, if none is missing.
  Duration worst_expectation{0};
};

// Frames keep their order: one that overtakes the one before it arrives together with it.
Counted run(const Line& line, std::int64_t ticks) {
  struct Arrival {
    TimePoint time;
    int frames;
    std::int64_t newest;
  };
  std::vector<Arrival> arrivals;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    if (line.drops(tick)) continue;
    const TimePoint time = kStart + tick * line.tick + line.late(tick);
    if (!arrivals.empty() && time <= arrivals.back().time) {
      ++arrivals.back().frames;
      arrivals.back().newest = tick;
    } else {
      arrivals.push_back({time, 1, tick});
    }
  }
  TickClock clock{kTickPeriod};
  Counted counted;
  for (const Arrival& arrival : arrivals) {
    int frames = arrival.frames;
    if (!clock.started()) {
      clock.start(arrival.time);
      if (--frames == 0) continue;
    }
    counted.lost += clock.arrived(arrival.time, frames);
    const Duration error = clock.expected() - (kStart + (arrival.newest + 1) * line.tick);
    if (arrival.newest > 200 && clock.missing() == 0) {
      counted.worst_expectation = std::max(counted.worst_expectation, std::max(error, -error));
    }
  }
  counted.ticks = clock.ticks();
  return counted;
}

TEST(TickClock, CountsFramesThatComeOnTime) {
  const Counted counted = run({}, 1000);
  EXPECT_EQ(counted.lost, 0);
  EXPECT_EQ(counted.ticks, 999) << "since the first";
  EXPECT_EQ(counted.worst_expectation, 0ns);
}

TEST(TickClock, IsNotStartedByItself) {
  TickClock clock{kTickPeriod};
  EXPECT_FALSE(clock.started());
  clock.start(kStart);
  EXPECT_TRUE(clock.started());
  EXPECT_EQ(clock.ticks(), 0);
  EXPECT_EQ(clock.expected(), kStart + kTickPeriod);
}

TEST(TickClock, TakesALateFrameForLate) {
  for (const Duration late : {Duration{1ms}, Duration{7ms}, Duration{11ms}, Duration{14ms}}) {
    const Line line{.late = [late](std::int64_t tick) { return tick % 10 == 9 ? late : 0ms; }};
    const Counted counted = run(line, 10'000);
    EXPECT_EQ(counted.lost, 0) << late.count();
    EXPECT_EQ(counted.ticks, 9999) << late.count();
    EXPECT_LE(counted.worst_expectation, 1ms) << late.count();
  }
}

TEST(TickClock, TakesAnyJitterBelowATickForLateness) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random{seed};
    std::exponential_distribution<double> jitter{1.0 / 2e6};  // ns
    const Line line{.late = [&](std::int64_t) {
      return std::min<Duration>(Duration{static_cast<std::int64_t>(jitter(random))}, 14ms);
    }};
    const Counted counted = run(line, 10'000);
    EXPECT_EQ(counted.lost, 0) << seed;
    EXPECT_EQ(counted.ticks, 9999) << seed;
    EXPECT_LE(counted.worst_expectation, 1ms) << seed;
  }
}

// The host stood still for a while, and found everything that had come meanwhile.
TEST(TickClock, CountsEachFrameOfABunch) {
  for (const std::int64_t bunch : {2, 3, 7, 20}) {
    const Line line{.late = [bunch](std::int64_t tick) {
      return tick > 100 && tick % 50 < bunch ? (bunch - 1 - tick % 50) * kTickPeriod : 0ms;
    }};
    const Counted counted = run(line, 10'000);
    EXPECT_EQ(counted.lost, 0) << bunch;
    EXPECT_EQ(counted.ticks, 9999) << bunch;
    EXPECT_EQ(counted.worst_expectation, 0ns) << bunch;
  }
}

// A USB adapter that passes on every 16 ms what has come: each frame is another ms late, and every
// sixteenth comes with the next.
TEST(TickClock, LosesNothingToAnAdapterThatBunches) {
  for (const Duration frame : {Duration{0ms}, Duration{2300us}, Duration{8ms}}) {
    for (Duration offset{0}; offset < 16ms; offset += 700us) {
      const Line line{.late = [&](std::int64_t tick) {
        const Duration whole = tick * kTickPeriod + frame + offset;
        const Duration handed_over = (whole + 16ms - 1ns) / 16ms * 16ms;
        return handed_over - offset - tick * kTickPeriod;
      }};
      const Counted counted = run(line, 10'000);
      EXPECT_EQ(counted.lost, 0) << frame.count() << ' ' << offset.count();
      EXPECT_EQ(counted.ticks, 9999) << frame.count() << ' ' << offset.count();
    }
  }
}

TEST(TickClock, CountsALostFrame) {
  const Line line{.drops = [](std::int64_t tick) { return tick % 40 == 20; }};
  const Counted counted = run(line, 10'000);
  EXPECT_EQ(counted.lost, 250);
  EXPECT_EQ(counted.ticks, 9999);
}

TEST(TickClock, CountsLostFramesInARow) {
  for (const std::int64_t gap : {2, 3, 5, 9}) {
    const Line line{.drops = [gap](std::int64_t tick) { return tick % 50 >= 50 - gap; }};
    const Counted counted = run(line, 10'040);
    EXPECT_EQ(counted.lost, 200 * gap) << gap;
    EXPECT_EQ(counted.ticks, 10'039) << gap;
  }
}

// A cable pulled out and put back: the time that passed is known once two frames are here.
TEST(TickClock, DoesNotWaitLongForWhatCannotBeLate) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  EXPECT_EQ(clock.arrived(kStart + 20 * kTickPeriod, 1), 0);
  EXPECT_EQ(clock.missing(), 19);
  EXPECT_EQ(clock.arrived(kStart + 21 * kTickPeriod, 1), 19);
  EXPECT_EQ(clock.ticks(), 21);
}

// The reader was woken by the first of many frames that were held up together.
TEST(TickClock, WaitsForABunchThatIsStillBeingHandedOver) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(clock.arrived(kStart + 20 * kTickPeriod + i * 20us, 1), 0) << i;
  }
  EXPECT_EQ(clock.ticks(), 20);
  EXPECT_EQ(clock.arrived(kStart + 21 * kTickPeriod, 1), 0);
  EXPECT_EQ(clock.ticks(), 21);
}

TEST(TickClock, TellsLostFromLateWhereBothHappen) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random{seed};
    std::exponential_distribution<double> jitter{1.0 / 1e6};  // ns
    const Line line{.late =
                        [&](std::int64_t) {
                          return std::min<Duration>(
                              Duration{static_cast<std::int64_t>(jitter(random))}, 14ms);
                        },
                    .drops = [](std::int64_t tick) { return tick % 40 == 20; }};
    const Counted counted = run(line, 10'000);
    EXPECT_EQ(counted.lost, 250) << seed;
    EXPECT_EQ(counted.ticks, 9999) << seed;
  }
}

// A frame known to be damaged needs no patience: its tick is counted with the next frame.
TEST(TickClock, BelievesAtOnceInAFrameThatWasSeenDamaged) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  EXPECT_EQ(clock.arrived(kStart + 2 * kTickPeriod, 1, 1), 1);
  EXPECT_EQ(clock.ticks(), 2);
  EXPECT_EQ(clock.missing(), 0);
  EXPECT_EQ(clock.arrived(kStart + 3 * kTickPeriod, 1, 1), 0) << "noise between frames is no frame";
  EXPECT_EQ(clock.ticks(), 3);
}

// A robot whose line is full of something else sends its frames much later, in a bunch.
TEST(TickClock, TakesBackWhatWasGivenUpAndComesAfterAll) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  EXPECT_EQ(clock.arrived(kStart + 9 * kTickPeriod, 1), 0);
  EXPECT_EQ(clock.arrived(kStart + 10 * kTickPeriod, 1), 8);
  for (int i = 1; i <= 8; ++i) {
    EXPECT_EQ(clock.arrived(kStart + 10 * kTickPeriod + i * 1ms, 1), -1) << i;
    EXPECT_TRUE(clock.in_phase());
  }
  EXPECT_EQ(clock.ticks(), 10);
  EXPECT_EQ(clock.arrived(kStart + 11 * kTickPeriod, 1), 0);
  EXPECT_EQ(clock.ticks(), 11);
  EXPECT_EQ(clock.expected(), kStart + 12 * kTickPeriod);
}

TEST(TickClock, TakesNothingBackASecondLater) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  (void)clock.arrived(kStart + 9 * kTickPeriod, 1);
  EXPECT_EQ(clock.arrived(kStart + 10 * kTickPeriod, 1), 8);
  for (int tick = 11; tick < 100; ++tick) (void)clock.arrived(kStart + tick * kTickPeriod, 1);
  EXPECT_EQ(clock.arrived(kStart + 99 * kTickPeriod + 5ms, 1), 0);
  EXPECT_FALSE(clock.in_phase());
}

// A given-up frame that is late by most of a tick does not mean that the robot is early.
TEST(TickClock, KeepsItsPhaseBehindALoss) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  EXPECT_EQ(clock.arrived(kStart + 9 * kTickPeriod - 3ms, 1), 0);
  EXPECT_EQ(clock.arrived(kStart + 10 * kTickPeriod - 3ms, 1), 8);
  EXPECT_EQ(clock.arrived(kStart + 11 * kTickPeriod - 3ms, 1), 0);
  EXPECT_GE(clock.expected(), kStart + 12 * kTickPeriod - 100us);
}

TEST(TickClock, IsInDoubtUntilTheSecondArrivalBehindASilence) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  EXPECT_EQ(clock.arrived(kStart + 4 * kTickPeriod, 1), 0);
  EXPECT_TRUE(clock.in_doubt());
  EXPECT_EQ(clock.arrived(kStart + 5 * kTickPeriod, 1), 3);
  EXPECT_FALSE(clock.in_doubt());
  EXPECT_EQ(clock.arrived(kStart + 8 * kTickPeriod, 1), 0);
  EXPECT_FALSE(clock.in_doubt()) << "two may be late";
}

TEST(TickClock, FollowsTheRobotsDrift) {
  for (const std::int64_t ppm : {-500, -20, 20, 500}) {
    const Line line{.tick = kTickPeriod + kTickPeriod * ppm / 1'000'000};
    const Counted counted = run(line, 100'000);
    EXPECT_EQ(counted.lost, 0) << ppm;
    EXPECT_EQ(counted.ticks, 99'999) << ppm;
    EXPECT_LE(counted.worst_expectation, 16us) << ppm;
  }
}

TEST(TickClock, FollowsTheDriftUnderJitterAndLoss) {
  for (const std::int64_t ppm : {-500, 500}) {
    std::mt19937 random{11};
    std::exponential_distribution<double> jitter{1.0 / 5e5};  // ns
    const Line line{.tick = kTickPeriod + kTickPeriod * ppm / 1'000'000,
                    .late =
                        [&](std::int64_t) {
                          return std::min<Duration>(
                              Duration{static_cast<std::int64_t>(jitter(random))}, 14ms);
                        },
                    .drops = [](std::int64_t tick) { return tick % 100 == 50; }};
    const Counted counted = run(line, 100'000);
    EXPECT_EQ(counted.lost, 1000) << ppm;
    EXPECT_EQ(counted.ticks, 99'999) << ppm;
  }
}

// The first frame came late, so all others seem early.
TEST(TickClock, FindsThePhaseWhereTheFirstFrameWasLate) {
  for (const Duration late : {Duration{1ms}, Duration{8ms}, Duration{14ms}}) {
    const Line line{.late = [late](std::int64_t tick) { return tick == 0 ? late : 0ms; }};
    const Counted counted = run(line, 1000);
    EXPECT_EQ(counted.lost, 0);
    EXPECT_EQ(counted.ticks, 999);
    EXPECT_EQ(counted.worst_expectation, 0ns);
  }
}

TEST(TickClock, KnowsWhichFrameWasDueLast) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  for (int tick = 1; tick <= 5; ++tick) (void)clock.arrived(kStart + tick * kTickPeriod, 1);
  const TimePoint due = kStart + 5 * kTickPeriod;
  EXPECT_EQ(clock.due_by(due), due);
  EXPECT_EQ(clock.due_by(due + kTickPeriod - 1ns), due);
  EXPECT_EQ(clock.due_by(due + kTickPeriod), due + kTickPeriod);
  EXPECT_EQ(clock.due_by(due + 7 * kTickPeriod + 3ms), due + 7 * kTickPeriod);
  EXPECT_EQ(clock.due_by(due - 1ns), due - kTickPeriod) << "also in the past";
  EXPECT_EQ(clock.due_by(due - 2 * kTickPeriod - 1ns), due - 3 * kTickPeriod);
}

TEST(TickClock, SaysWhereItsPhaseWasWrong) {
  TickClock clock{kTickPeriod};
  clock.start(kStart + 9ms);  // late, which is not known yet
  EXPECT_FALSE(clock.in_phase()) << "one frame shows no phase";
  (void)clock.arrived(kStart + kTickPeriod, 1);  // 9 ms before its time
  EXPECT_FALSE(clock.in_phase());
  (void)clock.arrived(kStart + 2 * kTickPeriod, 1);
  EXPECT_TRUE(clock.in_phase());
  (void)clock.arrived(kStart + 3 * kTickPeriod + 11ms, 1);
  EXPECT_TRUE(clock.in_phase()) << "late is no doubt about the phase";
  (void)clock.arrived(kStart + 4 * kTickPeriod - 1ms, 1);
  EXPECT_TRUE(clock.in_phase()) << "nor is a little early";
}

TEST(TickClock, KnowsItsPhaseOnceEnoughFramesHaveShownIt) {
  TickClock clock{kTickPeriod};
  clock.start(kStart + 9ms);
  (void)clock.arrived(kStart + kTickPeriod, 1);
  for (int tick = 2; tick < 2 + TickClock::kArrivalsToKnow; ++tick) {
    EXPECT_FALSE(clock.knows_phase()) << tick;
    (void)clock.arrived(kStart + tick * kTickPeriod, 1);
  }
  EXPECT_TRUE(clock.knows_phase());
  (void)clock.arrived(kStart + 20 * kTickPeriod + 9ms, 3);
  EXPECT_TRUE(clock.knows_phase()) << "late frames do not hide it";
  (void)clock.arrived(kStart + 21 * kTickPeriod - 3ms, 1);
  EXPECT_TRUE(clock.knows_phase());
  (void)clock.arrived(kStart + 21 * kTickPeriod + 5ms, 1);
  EXPECT_FALSE(clock.knows_phase()) << "too early to have been right";
  clock.start(kStart);
  EXPECT_FALSE(clock.knows_phase());
}

TEST(TickClock, BeginsAnewWhenStartedAgain) {
  TickClock clock{kTickPeriod};
  clock.start(kStart);
  (void)clock.arrived(kStart + 100 * kTickPeriod, 1);
  clock.start(kStart + 500ms);
  EXPECT_EQ(clock.ticks(), 0);
  EXPECT_EQ(clock.arrived(kStart + 500ms + kTickPeriod, 1), 0);
  EXPECT_EQ(clock.ticks(), 1);
}

}  // namespace
}  // namespace cargobay::rt
