#include "rt/wheel_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "rt/read_schedule.hpp"
#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

using test::Plant;
using test::PlantParameters;

constexpr auto kUndecided = RemainderBelief::unknown;
RemainderBelief belief_in(Remainder remainder) {
  return remainder == Remainder::carried ? RemainderBelief::carried : RemainderBelief::lost;
}

// The plant, driven open loop, and the estimator with the read schedule.
class Drive {
 public:
  explicit Drive(const PlantParameters& plant, const WheelEstimator::Parameters& estimator = {})
      : plant_{plant}, estimator_{estimator} {}

  enum class Frame { arrives, is_lost };

  void tick(const WheelSpeeds& command, Frame frame = Frame::arrives) {
    plant_.tick(command_);
    const WheelEstimator::Reading reading = plant_.read(reads_);
    if (frame == Frame::is_lost) {
      estimator_.step_lost(command_, reads_);
    } else {
      estimator_.step(command_, reading);
    }
    using Motion = ReadSchedule::Motion;
    const bool moves = command != WheelSpeeds{};
    reads_ = schedule_.next_reads({.belief = estimator_.belief(),
                                   .sure = estimator_.sure(),
                                   .motion = moves ? Motion::steady : Motion::none,
                                   .distance = estimator_.unread_distance(),
                                   .turn = estimator_.unread_turn()});
    command_ = command;
    ++ticks_;
  }
  void run(const WheelSpeeds& command, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(command);
  }
  // The worse of the two wheels, root mean square over the ticks.
  double rmse_over(const WheelSpeeds& command, int ticks) {
    double left = 0.0;
    double right = 0.0;
    for (int i = 0; i < ticks; ++i) {
      tick(command);
      left += std::pow(estimator_.speeds().left_mm_s - plant_.truth().left_mm_s, 2);
      right += std::pow(estimator_.speeds().right_mm_s - plant_.truth().right_mm_s, 2);
    }
    return std::sqrt(std::max(left, right) / ticks);
  }

  const WheelEstimator& estimator() const { return estimator_; }
  void doubt_command() { estimator_.doubt_command(); }
  Plant& plant() { return plant_; }

 private:
  Plant plant_;
  WheelEstimator estimator_;
  ReadSchedule schedule_{ReadSchedule::Parameters{}};
  WheelSpeeds command_{};
  Axes reads_ = kBothAxes;
  int ticks_ = 0;
};

class WheelEstimatorOfBothKinds : public testing::TestWithParam<Remainder> {};
INSTANTIATE_TEST_SUITE_P(WheelEstimator, WheelEstimatorOfBothKinds,
                         testing::Values(Remainder::carried, Remainder::lost),
                         [](const auto& tested) {
                           return tested.param == Remainder::carried ? "Carried" : "Lost";
                         });

TEST_P(WheelEstimatorOfBothKinds, FindsOutWithinASecondOfMotion) {
  const Remainder kind = GetParam();
  for (unsigned seed = 1; seed <= 40; ++seed) {
    for (const WheelSpeeds& command :
         {WheelSpeeds{50, 50}, WheelSpeeds{123, 123}, WheelSpeeds{-200, -200},
          WheelSpeeds{400, 400}, WheelSpeeds{-60, 60}, WheelSpeeds{-123, 123},
          WheelSpeeds{100, 200}}) {
      Drive drive{{.remainder = kind, .seed = seed}};
      drive.run({}, 20);
      drive.run(command, 67);
      ASSERT_EQ(drive.estimator().belief(), belief_in(kind))
          << "seed " << seed << ", " << command.left_mm_s << ' ' << command.right_mm_s
          << ", log odds " << drive.estimator().log_odds_carried();
    }
  }
}

// At 2.07 mm a tick the kinds hardly differ: it may stay open for long, but it is not mistaken.
TEST_P(WheelEstimatorOfBothKinds, IsNotMistakenWhereTicksLeaveLittleOver) {
  const Remainder other = GetParam() == Remainder::carried ? Remainder::lost : Remainder::carried;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Drive drive{{.remainder = GetParam(), .seed = seed}};
    drive.run({}, 20);
    for (int tick = 0; tick < 2000; ++tick) {
      drive.tick({150, 150});
      ASSERT_NE(drive.estimator().belief(), belief_in(other)) << "seed " << seed << ", " << tick;
    }
  }
}

TEST_P(WheelEstimatorOfBothKinds, NeverDecidesAtRest) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Drive drive{{.remainder = GetParam(), .seed = seed}};
    for (int minute = 0; minute < 10; ++minute) {
      drive.run({}, 4000);
      ASSERT_EQ(drive.estimator().belief(), kUndecided) << minute;
    }
    drive.run({123, 123}, 67);
    EXPECT_EQ(drive.estimator().belief(), belief_in(GetParam())) << "and is not worn out by it";
  }
}

TEST_P(WheelEstimatorOfBothKinds, KnowsTheSpeedAfterASecond) {
  const double most = GetParam() == Remainder::carried ? 4.0 : 6.0;
  for (const WheelSpeeds& command :
       {WheelSpeeds{50, 50}, WheelSpeeds{250, 250}, WheelSpeeds{-400, -400}, WheelSpeeds{-150, 150},
        WheelSpeeds{120, 240}}) {
    Drive drive{{.remainder = GetParam()}};
    drive.run(command, 67);
    EXPECT_LE(drive.rmse_over(command, 400), most)
        << command.left_mm_s << ' ' << command.right_mm_s;
  }
}

// Ten minutes each at speeds of a whole number of millimetres, or a whole degree, per tick: every
// reading is then the same, and says the same again and again.
TEST_P(WheelEstimatorOfBothKinds, DoesNotChangeItsMindOverALongSteadyDrive) {
  const double degree_a_tick = 258.0 * std::numbers::pi / 180.0 / Plant::kTick / 2.0;
  for (const double noise_mm_s : {0.0, 1.0}) {
    for (const WheelSpeeds& speeds :
         {WheelSpeeds{200, 200}, WheelSpeeds{66.0 + 2.0 / 3.0, 66.0 + 2.0 / 3.0},
          WheelSpeeds{-400, -400}, WheelSpeeds{-degree_a_tick, degree_a_tick}}) {
      Drive drive{
          {.remainder = GetParam(), .gain_left = 1.0, .gain_right = 1.0, .noise_mm_s = noise_mm_s}};
      drive.run({123, 123}, 67);
      ASSERT_EQ(drive.estimator().belief(), belief_in(GetParam()));
      for (int tick = 0; tick < 40'000; ++tick) {
        drive.tick(speeds);
        ASSERT_EQ(drive.estimator().belief(), belief_in(GetParam()))
            << speeds.left_mm_s << ' ' << speeds.right_mm_s << " noise " << noise_mm_s << ", tick "
            << tick << ", log odds " << drive.estimator().log_odds_carried();
      }
    }
  }
}

TEST_P(WheelEstimatorOfBothKinds, ChangesItsMindWhereItWasWrong) {
  Drive drive{{.remainder = GetParam()}};
  drive.run({123, 123}, 2000);
  ASSERT_EQ(drive.estimator().belief(), belief_in(GetParam()));
  // Another robot on the same wires, with the other kind of remainder.
  const Remainder other = GetParam() == Remainder::carried ? Remainder::lost : Remainder::carried;
  drive.plant() = Plant{{.remainder = other}};
  drive.run({123, 123}, 8000);  // two minutes
  EXPECT_EQ(drive.estimator().belief(), belief_in(other));
}

TEST_P(WheelEstimatorOfBothKinds, IsNotMisledByLostFrames) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Drive drive{{.remainder = GetParam(), .seed = seed}};
    std::mt19937 random{seed};
    const WheelSpeeds command{120, 240};
    double worst = 0.0;
    for (int tick = 0; tick < 4000; ++tick) {
      const bool lost = random() % 20 == 0;
      drive.tick(command, lost ? Drive::Frame::is_lost : Drive::Frame::arrives);
      if (tick < 200) continue;
      worst = std::max(
          worst, std::abs(drive.estimator().speeds().left_mm_s - drive.plant().truth().left_mm_s));
    }
    EXPECT_EQ(drive.estimator().belief(), belief_in(GetParam())) << seed;
    EXPECT_LT(worst, 35.0) << seed;
  }
}

// Neither from what it reads, which is of the past, nor from the next, which lacks it.
TEST_P(WheelEstimatorOfBothKinds, DrawsNoConclusionFromAFrameThatComesAfterAll) {
  Drive drive{{.remainder = GetParam()}};
  drive.run({200, 200}, 400);
  WheelEstimator estimator = drive.estimator();
  const double before = estimator.log_odds_carried();
  estimator.step_lost({200, 200}, kBothAxes);
  estimator.came_after_all(1);
  estimator.step({200, 200}, WheelEstimator::Reading{.distance_mm = 90, .angle_deg = 0});
  EXPECT_EQ(estimator.log_odds_carried(), before);
  estimator.step({200, 200}, WheelEstimator::Reading{.distance_mm = 0, .angle_deg = 0});
  EXPECT_EQ(estimator.log_odds_carried(), before);
  EXPECT_NEAR(estimator.speeds().left_mm_s, drive.estimator().speeds().left_mm_s, 2.0);
}

// Of a counter that stands; but after a lost frame it may be that one which took the steps.
TEST_P(WheelEstimatorOfBothKinds, FindsStrangeOnlyWhatItKnowsTheTimeOf) {
  Drive drive{{.remainder = GetParam()}, {.remainder = GetParam()}};
  drive.run({200, 200}, 400);
  WheelEstimator estimator = drive.estimator();
  for (int tick = 0; tick < 12; ++tick) estimator.step({200, 200}, {});
  WheelEstimator healthy = estimator;
  const int foreseen = static_cast<int>(std::lround(healthy.unread_distance().steps));
  healthy.step({200, 200}, WheelEstimator::Reading{.distance_mm = foreseen});
  EXPECT_FALSE(healthy.seen().strange);
  WheelEstimator unsure = estimator;
  unsure.step_lost({200, 200}, kBothAxes);
  unsure.step({200, 200}, WheelEstimator::Reading{.distance_mm = 0});
  EXPECT_FALSE(unsure.seen().strange);
  estimator.step({200, 200}, WheelEstimator::Reading{.distance_mm = 0});
  EXPECT_EQ(estimator.seen().strange, GetParam() == Remainder::lost) << "nobody asks otherwise";
}

TEST_P(WheelEstimatorOfBothKinds, DrawsNoConclusionFromACommandOfUnknownTime) {
  Drive drive{{.remainder = GetParam()}};
  drive.run({200.0, -200.0}, 200);
  const double before = drive.estimator().log_odds_carried();
  drive.doubt_command();
  drive.run({0.0, 0.0}, 10);
  EXPECT_EQ(drive.estimator().log_odds_carried(), before);
  drive.doubt_command();
  drive.run({-200.0, 200.0}, 8);
  EXPECT_EQ(drive.estimator().log_odds_carried(), before) << "three lags";
}

TEST_P(WheelEstimatorOfBothKinds, GoesOnByTheModelWhereNothingArrives) {
  Drive drive{{.remainder = GetParam()}};
  const WheelSpeeds command{150, 300};
  drive.run(command, 400);
  for (int tick = 0; tick < 67; ++tick) {
    drive.tick(command, Drive::Frame::is_lost);
    EXPECT_NEAR(drive.estimator().speeds().left_mm_s, drive.plant().truth().left_mm_s, 20.0);
    EXPECT_NEAR(drive.estimator().speeds().right_mm_s, drive.plant().truth().right_mm_s, 20.0);
  }
  drive.run(command, 40);
  EXPECT_LE(drive.rmse_over(command, 100), 8.0);
}

// The counters have been counting for an unknown time.
TEST_P(WheelEstimatorOfBothKinds, DiscardsTheFirstReading) {
  WheelEstimator estimator{{}};
  estimator.step({}, WheelEstimator::Reading{.distance_mm = 12'345, .angle_deg = -678});
  EXPECT_EQ(estimator.speeds(), WheelSpeeds{});
  EXPECT_EQ(estimator.belief(), kUndecided);
}

// One impossible reading in the middle of a drive.
TEST_P(WheelEstimatorOfBothKinds, RejectsAStepThatNoRobotCanMake) {
  for (const WheelEstimator::Reading& junk :
       {WheelEstimator::Reading{.distance_mm = 30'000, .angle_deg = 0},
        WheelEstimator::Reading{.distance_mm = -32'768, .angle_deg = 32'767},
        WheelEstimator::Reading{.distance_mm = 3, .angle_deg = -400}}) {
    WheelEstimator estimator{{.remainder = GetParam()}};
    Plant plant{{.remainder = GetParam()}};
    const WheelSpeeds command{200, 200};
    for (int tick = 0; tick < 600; ++tick) {
      plant.tick(command);
      WheelEstimator::Reading reading;
      if (GetParam() == Remainder::carried || tick % 40 == 0) reading = plant.read();
      if (tick == 400) reading = junk;
      estimator.step(command, reading);
      if (tick < 200) continue;
      ASSERT_NEAR(estimator.speeds().left_mm_s, plant.truth().left_mm_s, 12.0) << tick;
      ASSERT_NEAR(estimator.speeds().right_mm_s, plant.truth().right_mm_s, 12.0) << tick;
    }
  }
}

TEST_P(WheelEstimatorOfBothKinds, DoesNotAskWhereTheKindIsGiven) {
  const Remainder other = GetParam() == Remainder::carried ? Remainder::lost : Remainder::carried;
  Drive drive{{.remainder = other}, {.remainder = GetParam()}};
  EXPECT_EQ(drive.estimator().belief(), belief_in(GetParam())) << "from the start";
  drive.run({150, 150}, 2000);
  EXPECT_EQ(drive.estimator().belief(), belief_in(GetParam())) << "and whatever is read";
}

TEST_P(WheelEstimatorOfBothKinds, FollowsAChangeOfDirection) {
  Drive drive{{.remainder = GetParam()}};
  drive.run({200, 200}, 400);
  drive.run({-200, -200}, 67);
  EXPECT_LE(drive.rmse_over({-200, -200}, 200), 6.0);
  drive.run({}, 67);
  EXPECT_NEAR(drive.estimator().speeds().left_mm_s, 0.0, 3.0);
}

TEST(WheelEstimator, StatesItsOwnUncertainty) {
  Drive drive{{}};
  double covered = 0;
  drive.run({180, 240}, 100);
  constexpr int kTicks = 4000;
  for (int tick = 0; tick < kTicks; ++tick) {
    drive.tick({180, 240});
    const double error =
        std::abs(drive.estimator().speeds().left_mm_s - drive.plant().truth().left_mm_s);
    if (error <= 2.0 * drive.estimator().speed_sd_mm_s()) ++covered;
  }
  EXPECT_GT(covered / kTicks, 0.9) << "twice the standard deviation";
  EXPECT_LT(drive.estimator().speed_sd_mm_s(), 20.0);
}

TEST(WheelEstimator, ForgetsOnReset) {
  Drive drive{{}};
  drive.run({200, 200}, 300);
  WheelEstimator estimator = drive.estimator();
  estimator.reset();
  EXPECT_EQ(estimator.belief(), kUndecided);
  EXPECT_EQ(estimator.speeds(), WheelSpeeds{});
}

// Left and right are not swapped.
TEST(WheelEstimator, TellsLeftFromRight) {
  Drive drive{{}};
  drive.run({100, 300}, 200);
  EXPECT_NEAR(drive.estimator().speeds().left_mm_s, 94.0, 10.0);
  EXPECT_NEAR(drive.estimator().speeds().right_mm_s, 270.0, 10.0);
}

// The very same bits again: recordings can be replayed.
TEST(WheelEstimator, IsDeterministic) {
  Drive one{{.seed = 5}};
  Drive other{{.seed = 5}};
  for (int tick = 0; tick < 2000; ++tick) {
    const WheelSpeeds command{100.0 + tick % 100, 200.0};
    one.tick(command);
    other.tick(command);
    ASSERT_EQ(one.estimator().speeds(), other.estimator().speeds());
    ASSERT_EQ(one.estimator().log_odds_carried(), other.estimator().log_odds_carried());
  }
}

}  // namespace
}  // namespace cargobay::rt
