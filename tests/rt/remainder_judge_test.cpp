#include "rt/remainder_judge.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "rt/remainder.hpp"
#include "rt/wheel_estimator.hpp"
#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

using Counts = RemainderJudge::Counts;
enum class Axis { distance, turn };

constexpr int kWindow = 8;        // ticks
constexpr int kSingles = 8;       // readings of one tick each
constexpr double kDecides = 5.0;  // the estimator asks for no less
constexpr double kMostEvidence = 4.0;
static_assert(kDecides <= WheelEstimator::Parameters{}.decision_log_odds);

Counts along(Axis axis, int count) {
  return axis == Axis::distance ? Counts{.distance = count} : Counts{.turn = count};
}

// A counter that goes `rate` steps each tick, give or take a little, read in windows and tick by
// tick in turn.
class Counter {
 public:
  Counter(Remainder remainder, unsigned seed, double wander = 0.0)
      : remainder_{remainder}, random_{seed}, wander_{wander} {
    if (remainder == Remainder::carried) steps_ = std::uniform_real_distribution{}(random_);
  }
  int read(int ticks, double rate) {
    for (int tick = 0; tick < ticks; ++tick) {
      astray_ = 0.86 * astray_ + wander_ * normal_(random_);
      steps_ += rate + astray_;
    }
    const double whole = std::trunc(steps_);
    steps_ = remainder_ == Remainder::carried ? steps_ - whole : 0.0;
    return static_cast<int>(whole);
  }

 private:
  Remainder remainder_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double wander_;
  double steps_ = 0.0;
  double astray_ = 0.0;
};

// Single readings and a window, as the schedule goes on in turn; the first time, it says nothing.
double one_test(RemainderJudge& judge, Counter& counter, Axis axis, double rate) {
  double evidence = 0.0;
  for (int i = 0; i < kSingles; ++i) {
    evidence += judge.read(1, along(axis, counter.read(1, rate)));
  }
  return evidence + judge.read(kWindow, along(axis, counter.read(kWindow, rate)));
}

double towards(Remainder remainder, double evidence) {
  return remainder == Remainder::carried ? evidence : -evidence;
}

class RemainderJudgeOfBothKinds : public testing::TestWithParam<Remainder> {};
INSTANTIATE_TEST_SUITE_P(RemainderJudge, RemainderJudgeOfBothKinds,
                         testing::Values(Remainder::carried, Remainder::lost),
                         [](const auto& tested) {
                           return tested.param == Remainder::carried ? "Carried" : "Lost";
                         });

// Where a tick leaves a quarter to three quarters of a step, three tests in a row decide.
TEST_P(RemainderJudgeOfBothKinds, TellsTheKindByEitherAxisAndSign) {
  for (const Axis axis : {Axis::distance, Axis::turn}) {
    for (int percent = 30; percent < 750; percent += 3) {
      const double rate = 0.01 * percent;
      const double part = rate - std::floor(rate);
      if (part < 0.3 || part > 0.8) continue;
      for (const double sign : {1.0, -1.0}) {
        for (unsigned seed = 1; seed <= 5; ++seed) {
          RemainderJudge judge;
          Counter counter{GetParam(), seed, 0.01};
          double evidence = 0.0;
          for (int i = 0; i < 4; ++i) evidence += one_test(judge, counter, axis, sign * rate);
          ASSERT_GT(towards(GetParam(), evidence), kDecides) << sign * rate << " seed " << seed;
        }
      }
    }
  }
}

// Over a long drive at any speed. Near a whole number of steps a tick it may stay open, but it is
// not wrong: at a little more than that, single readings hardly fall short.
TEST_P(RemainderJudgeOfBothKinds, IsNotMisledAtAnySpeed) {
  for (const double wander : {0.0, 0.02}) {
    int drives = 0;
    int wrong = 0;
    for (int thousandth = 260; thousandth < 7500; thousandth += 17) {
      const double rate = 0.001 * thousandth;
      for (unsigned seed = 1; seed <= 10; ++seed) {
        RemainderJudge judge;
        Counter counter{GetParam(), 1000 * seed + static_cast<unsigned>(1000.0 * rate), wander};
        double odds = 0.0;
        double worst = 0.0;
        for (int i = 0; i < 80; ++i) {
          odds = std::clamp(odds + one_test(judge, counter, Axis::distance, rate), -20.0, 20.0);
          worst = std::min(worst, towards(GetParam(), odds));
        }
        ++drives;
        if (worst <= -kDecides) ++wrong;
      }
    }
    RecordProperty(wander > 0.0 ? "wrong_if_unsteady" : "wrong", wrong);
    EXPECT_LE(wrong, drives / 1000) << "of " << drives << ", speed noise " << wander;
  }
}

// 200 mm/s is 3.000 mm a tick: both kinds then read the same.
TEST_P(RemainderJudgeOfBothKinds, SaysNothingIfTicksLeaveNothingOver) {
  for (const int count : {1, 2, 3, 5, 7}) {
    for (const int sign : {1, -1}) {
      RemainderJudge judge;
      double evidence = 0.0;
      for (int i = 0; i < 1000; ++i) {
        evidence += judge.read(kWindow, {.distance = sign * kWindow * count});
        for (int k = 0; k < kSingles; ++k) evidence += judge.read(1, {.distance = sign * count});
      }
      EXPECT_EQ(evidence, 0.0) << sign * count;
    }
  }
}

// Less than what settles the kind, so that no single event decides.
TEST_P(RemainderJudgeOfBothKinds, BoundsWhatOneTestCanSay) {
  double most = 0.0;
  for (int percent = 20; percent < 750; ++percent) {
    const double rate = 0.01 * percent;
    RemainderJudge judge;
    Counter counter{GetParam(), 1};
    (void)one_test(judge, counter, Axis::distance, rate);
    most = std::max(most, std::abs(one_test(judge, counter, Axis::distance, rate)));
    RemainderJudge of_both;
    Counter other{GetParam(), 1};
    const auto both = [&](int ticks) {
      const int count = other.read(ticks, rate);
      return of_both.read(ticks, {.distance = count, .turn = -count});
    };
    (void)both(kWindow);
    for (int i = 0; i < kSingles; ++i) (void)both(1);
    most = std::max(most, std::abs(both(kWindow)) / 2.0);
  }
  EXPECT_LE(most, kMostEvidence);
  EXPECT_GT(most, 0.9 * kMostEvidence) << "and can be clear";
}

// The same readings that tell the kind, spoilt.
class Spoilt : public testing::Test {
 protected:
  static constexpr int kWindowCount = 28;  // 3.5 a tick, and 3 in each single one: lost
  double drive(int former, int single, int latter, int missed_after = -1) {
    RemainderJudge judge;
    double evidence = judge.read(kWindow, {.distance = former});
    for (int i = 0; i < kSingles; ++i) {
      evidence += judge.read(1, {.distance = single});
      if (i == missed_after) judge.doubt();
    }
    return evidence + judge.read(kWindow, {.distance = latter});
  }
};

TEST_F(Spoilt, NotAtAll) { EXPECT_LT(drive(kWindowCount, 3, kWindowCount), -3.9); }

TEST_F(Spoilt, WindowsThatDifferSayNothing) {
  EXPECT_EQ(drive(kWindowCount, 3, kWindowCount / 2), 0.0);
  EXPECT_EQ(drive(kWindowCount / 2, 3, kWindowCount), 0.0);
  EXPECT_EQ(drive(kWindowCount, 3, -kWindowCount), 0.0) << "a reversal";
  EXPECT_EQ(drive(kWindowCount, 3, 0), 0.0) << "a stop";
}

TEST_F(Spoilt, AMissedReadingSaysNothing) {
  for (int after = 0; after < kSingles; ++after) {
    EXPECT_EQ(drive(kWindowCount, 3, kWindowCount, after), 0.0) << after;
  }
}

TEST_F(Spoilt, WhatFitsNeitherKindSaysNothing) {
  EXPECT_EQ(drive(kWindowCount, 1, kWindowCount), 0.0);
  EXPECT_EQ(drive(kWindowCount, 6, kWindowCount), 0.0);
}

TEST_F(Spoilt, FewReadingsOrShortWindowsSayNothing) {
  const auto short_drive = [](int window, int singles) {
    RemainderJudge judge;
    (void)judge.read(window, {.distance = window * 7 / 2});
    for (int i = 0; i < singles; ++i) (void)judge.read(1, {.distance = 3});
    return judge.read(window, {.distance = window * 7 / 2});
  };
  EXPECT_EQ(short_drive(8, 5), 0.0);
  EXPECT_EQ(short_drive(4, 8), 0.0);
  EXPECT_LT(short_drive(8, 8), -3.9);
}

// Motors of any lag, dead time and ramp, started, stopped and reversed without a rest: their answer
// is no evidence.
TEST_P(RemainderJudgeOfBothKinds, IsNotMisledByTransients) {
  int wrong = 0;
  double worst = 0.0;
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    test::PlantParameters parameters = test::any_plant(seed, GetParam());
    parameters.step_mm_s = 0.0;
    test::Plant plant{parameters};
    std::mt19937 random{seed};
    const auto draw = [&random](double least, double most) {
      return std::uniform_real_distribution<double>{least, most}(random);
    };
    RemainderJudge judge;
    double odds = 0.0;
    double least = 0.0;
    WheelSpeeds command;
    int until = 0;
    for (int tick = 0; tick < 660; ++tick) {
      if (tick == until) {
        command = {draw(-300.0, 300.0), draw(-300.0, 300.0)};
        if (random() % 4 == 0) command = {};
        until += static_cast<int>(draw(5.0, 60.0));
      }
      plant.tick(command);
      const int phase = tick % (kWindow + kSingles);
      if (phase < kWindow - 1) continue;
      const auto reading = plant.read();
      const int ticks = phase == kWindow - 1 ? kWindow : 1;
      odds += judge.read(ticks, {.distance = *reading.distance_mm, .turn = *reading.angle_deg});
      odds = std::clamp(odds, -20.0, 20.0);
      least = std::min(least, towards(GetParam(), odds));
    }
    worst = std::min(worst, least);
    if (least <= -kDecides) ++wrong;
  }
  RecordProperty("wrong", wrong);
  EXPECT_EQ(wrong, 0) << "of 1000; the worst odds were " << worst;
}

}  // namespace
}  // namespace cargobay::rt
