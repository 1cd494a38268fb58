#include "rt/read_schedule.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using Motion = ReadSchedule::Motion;

enum class Sure : bool { no, yes };

// `count` ticks as a picture: R reads both counters, D the distance alone, A the angle, a dot none.
std::string counters(ReadSchedule& schedule, int count, const ReadSchedule::Now& now) {
  std::string picture;
  for (int i = 0; i < count; ++i) {
    const Axes reads = schedule.next_reads(now);
    picture += reads.both() ? 'R' : reads.distance ? 'D' : reads.turn ? 'A' : '.';
  }
  return picture;
}
// The same, R for any.
std::string ticks(ReadSchedule& schedule, int count, RemainderBelief belief, Motion motion,
                  Sure sure = Sure::yes) {
  std::string picture = counters(schedule, count,
                                 {.belief = belief,
                                  .sure = sure == Sure::yes,
                                  .motion = motion,
                                  .distance = {.steps_a_tick = 3.0}});
  std::ranges::replace_if(picture, [](char tick) { return tick != '.'; }, 'R');
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

// How often a whole series of single readings is in it.
int rows_in(const std::string& picture) {
  int rows = 0;
  for (std::size_t at = picture.find(reads(8)); at != std::string::npos;
       at = picture.find(reads(8), at + 8)) {
    ++rows;
  }
  return rows;
}
// The longest window in it, ticks.
int widest_in(const std::string& picture) {
  int widest = 0;
  int now = 0;
  for (const char tick : picture) {
    ++now;
    widest = std::max(widest, now);
    if (tick == 'R') now = 0;
  }
  return widest;
}

constexpr auto kUnknown = RemainderBelief::unknown;
constexpr auto kCarried = RemainderBelief::carried;
constexpr auto kLost = RemainderBelief::lost;

TEST(ReadSchedule, ReadsEveryTickAtRest) {
  for (const auto belief : {kUnknown, kCarried}) {
    ReadSchedule schedule{{}};
    EXPECT_EQ(counters(schedule, 500, {.belief = belief}), reads(500));
  }
}

// A window ends in a reading of its own, from which the single ones count.
TEST(ReadSchedule, DoesBothInTurnWhileTheKindIsNotKnown) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 9, kUnknown, Motion::steady), window(4) + window(4) + ".");
  EXPECT_EQ(ticks(schedule, 7 + 2 * 16, kUnknown, Motion::steady),
            window(7) + reads(8) + window(8) + reads(8) + window(8));
}

// Until the speed is steady, or the robot has moved for long enough, the evidence would be poor;
// short windows show how the wheels begin.
TEST(ReadSchedule, KeepsToWindowsUntilTheKindCanBeSeen) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 6, kUnknown, Motion::changing), window(4) + "..");
  EXPECT_EQ(ticks(schedule, 10, kUnknown, Motion::steady), ".R" + window(4) + "....")
      << "not steady for long enough";
  EXPECT_EQ(ticks(schedule, 4 + 8 + 8, kUnknown, Motion::steady), window(4) + reads(8) + window(8));
  ReadSchedule restless{{}};
  EXPECT_EQ(ticks(restless, 19, kUnknown, Motion::changing), repeated(window(4), 4) + "...");
  EXPECT_EQ(ticks(restless, 5 + 8 + 8, kUnknown, Motion::changing),
            window(5) + reads(8) + window(8));
}

TEST(ReadSchedule, BeginsAgainWithEachMotion) {
  ReadSchedule schedule{{}};
  const auto begin = window(4) + window(4);
  EXPECT_EQ(ticks(schedule, 8 + 8 + 5, kUnknown, Motion::steady), begin + window(8) + reads(5));
  EXPECT_EQ(ticks(schedule, 3, kUnknown, Motion::none), reads(3));
  EXPECT_EQ(ticks(schedule, 8 + 8 + 8, kUnknown, Motion::steady), begin + window(8) + reads(8));
}

TEST(ReadSchedule, ReadsEveryTickWhereTheRemainderIsCarried) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 199, kCarried, Motion::steady), reads(199));
  ReadSchedule restless{{}};
  EXPECT_EQ(ticks(restless, 199, kCarried, Motion::changing), reads(199));
}

// A window, single readings, a window: what the judge of the kind needs.
TEST(ReadSchedule, TriesNowAndThenWhetherItIsStillCarried) {
  ReadSchedule schedule{{}};
  const std::string period = reads(199) + window(8) + reads(8) + window(8) + 'R';
  EXPECT_EQ(ticks(schedule, 3 * 224, kCarried, Motion::steady), repeated(period, 3));
}

TEST(ReadSchedule, TriesMoreOftenWhatLittleSpeaksFor) {
  ReadSchedule schedule{{}};
  const std::string period = reads(59) + window(8) + reads(8) + window(8) + 'R';
  EXPECT_EQ(ticks(schedule, 3 * 84, kCarried, Motion::steady, Sure::no), repeated(period, 3));
  ReadSchedule of_lost{{}};
  const std::string picture = ticks(of_lost, 840, kLost, Motion::steady, Sure::no);
  EXPECT_GE(rows_in(picture), 7);
}

// Time at rest neither brings a check closer nor is one made of it.
TEST(ReadSchedule, CountsOnlyTicksOfMotion) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 150, kCarried, Motion::steady), reads(150));
  EXPECT_EQ(ticks(schedule, 1000, kCarried, Motion::none), reads(1000));
  EXPECT_EQ(ticks(schedule, 49 + 8, kCarried, Motion::steady), reads(49) + window(8));
}

TEST(ReadSchedule, WidensTheWindowOnceTheSpeedIsSteady) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 12, kLost, Motion::steady), window(6) + window(6));
  const std::string picture = ticks(schedule, 240, kLost, Motion::steady);
  EXPECT_NE(picture.find(window(12) + window(12) + window(12)), std::string::npos) << picture;
  EXPECT_EQ(widest_in(picture), 12);
}

TEST(ReadSchedule, ReadsSoonAfterAChangeOfSpeed) {
  ReadSchedule schedule{{}};
  std::string picture = ticks(schedule, 300, kLost, Motion::steady);
  while (picture.substr(picture.size() - 10) != std::string(10, '.')) {
    picture += ticks(schedule, 1, kLost, Motion::steady);
  }
  EXPECT_EQ(ticks(schedule, 7, kLost, Motion::changing), "R" + window(6))
      << "what was travelled before the change is read at once";
  EXPECT_EQ(ticks(schedule, 12, kLost, Motion::steady), window(6) + window(6));
}

TEST(ReadSchedule, KeepsWindowsShortWhileTheSpeedChanges) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(ticks(schedule, 198, kLost, Motion::changing), repeated(window(6), 33));
}

TEST(ReadSchedule, SeldomTriesWhetherItIsStillLost) {
  ReadSchedule schedule{{}};
  const std::string picture = ticks(schedule, 10'240, kLost, Motion::steady);
  EXPECT_EQ(rows_in(picture), 10);
  EXPECT_LE(std::count(picture.begin(), picture.end(), 'R'), 10 * (1024 / 12 + 8 + 3));
}

TEST(ReadSchedule, TakesItsLengthsFromItsParameters) {
  ReadSchedule schedule{{.probe_window_ticks = 3, .probe_reads = 2, .probe_steady_ticks = 1}};
  EXPECT_EQ(ticks(schedule, 10, kUnknown, Motion::steady), "..RRR..RRR");
}

// What has gathered of the angle: steps, and how sure.
ReadSchedule::Now losing(double steps, double sd, int blank_ticks = 0) {
  return {.belief = kLost,
          .sure = true,
          .motion = Motion::changing,
          .distance = {.steps_a_tick = 3.0},
          .turn = {.steps = steps, .sd = sd, .blank_ticks = blank_ticks}};
}

TEST(ReadSchedule, ReadsTheAngleOfARobotThatLosesItOnlyWhenThatTells) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(counters(schedule, 600, losing(0.0, 0.9)), repeated(".....D", 100)) << "near nothing";
  EXPECT_EQ(counters(schedule, 18, losing(3.0, 0.6)), ".....R.....D.....D") << "after so long";
  EXPECT_EQ(counters(schedule, 24, losing(3.0, 1.0)), ".....R.....D.....R.....D")
      << "and then not at once";
}

// Later, with the distance: then it is known how far each wheel has gone.
TEST(ReadSchedule, ReadsTheAngleAtAnyTimeInTheFirstSeconds) {
  ReadSchedule schedule{{}};
  EXPECT_EQ(counters(schedule, 24, losing(3.0, 1.0)), ".....D....AD.....D...A.D");
}

// On the spot, where no distance shows that it stands.
TEST(ReadSchedule, ReadsTheAngleOfARobotThatTurnsNowAndThen) {
  ReadSchedule schedule{{}};
  ReadSchedule::Now turns = losing(8.0, 0.1);
  (void)counters(schedule, 300, turns);
  const auto angles = [&] {
    const std::string picture = counters(schedule, 300, turns);
    return std::ranges::count_if(picture, [](char tick) { return tick == 'A' || tick == 'R'; });
  };
  EXPECT_LE(angles(), 3);
  turns.distance.steps_a_tick = 0.0;
  EXPECT_EQ(angles(), 10);
}

// Both, the first of them at once; then in windows that grow, at a low speed from the first one on.
TEST(ReadSchedule, ReadsWindowsOfBothWhileCountersAreInDoubt) {
  ReadSchedule::Now doubtful = losing(0.0, 0.1);
  doubtful.motion = Motion::doubtful;
  doubtful.driven_mm = 3.0;
  ReadSchedule schedule{{}};
  EXPECT_EQ(counters(schedule, 25, doubtful), "R" + repeated(".....R", 4));
  (void)counters(schedule, 100, doubtful);
  EXPECT_EQ(
      counters(schedule, 240, doubtful).find("R" + std::string(23, '.') + "R") != std::string::npos,
      true);
  ReadSchedule slow{{}};
  doubtful.driven_mm = 0.75;
  EXPECT_EQ(counters(slow, 25, doubtful), "R" + repeated(std::string(11, '.') + "R", 2));
}

TEST(ReadSchedule, WaitsTwiceAsLongForAnAngleThatWasNothing) {
  ReadSchedule schedule{{}};
  const auto angles = [](const std::string& picture) {
    return std::ranges::count_if(picture, [](char tick) { return tick == 'A' || tick == 'R'; });
  };
  EXPECT_EQ(angles(counters(schedule, 200, losing(0.0, 2.0, 100))), 0);
  EXPECT_EQ(angles(counters(schedule, 6, losing(0.0, 2.0, 100))), 1);
  (void)counters(schedule, 20, losing(0.0, 2.0, 100));
  EXPECT_EQ(angles(counters(schedule, 6, losing(0.0, 5.0, 100))), 1) << "so much cannot wait";
}

// At a stop, what is left of a step belongs to the next motion.
TEST(ReadSchedule, LeavesTheAngleAloneAtAShortStop) {
  ReadSchedule schedule{{}};
  ReadSchedule::Now stands = losing(0.4, 0.5);
  stands.motion = Motion::none;
  EXPECT_EQ(counters(schedule, 132, stands), std::string(132, 'D'));
  EXPECT_EQ(counters(schedule, 2, stands), "RR");
}

// A single tick in which the robot hardly turns only loses; one that spins shows in the angle.
TEST(ReadSchedule, ProbesTheAxisThatShowsTheKind) {
  ReadSchedule::Now now{.motion = Motion::steady, .distance = {.steps_a_tick = 3.0}};
  ReadSchedule straight{{}};
  EXPECT_EQ(counters(straight, 8 + 16, now),
            "...D...D"
            ".......D"
            "DDDDDDDD");
  now.turn.steps_a_tick = 0.6;
  ReadSchedule arc{{}};
  EXPECT_EQ(counters(arc, 8 + 16, now),
            "...R...R"
            ".......R"
            "RRRRRRRR");
  now.distance.steps_a_tick = 0.0;
  ReadSchedule spin{{}};
  EXPECT_EQ(counters(spin, 8 + 16, now),
            "...R...R"
            ".......R"
            "AAAAAAAA");
}

}  // namespace
}  // namespace cargobay::rt
