#include "rt/wheel_loop.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

using test::Plant;
using test::PlantParameters;

// The loop around the plant, tick by tick, as the control cycle runs it.
class ClosedLoop {
 public:
  explicit ClosedLoop(const PlantParameters& plant, const WheelLoop::Parameters& parameters = {})
      : plant_{plant}, loop_{parameters} {}

  // `off_mm`: by which the next distance that is read is wrong.
  void tick(const WheelSpeeds& target, int off_mm = 0) {
    off_mm_ += off_mm;
    plant_.tick(command_);
    WheelEstimator::Reading reading = plant_.read(reads_);
    if (reading.distance_mm) *reading.distance_mm += std::exchange(off_mm_, 0);
    loop_.frame(reading);
    command_ = loop_.control(target);
    reads_ = loop_.next_reads();
  }
  void run(const WheelSpeeds& target, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(target);
  }
  WheelSpeeds mean_over(const WheelSpeeds& target, int ticks) {
    WheelSpeeds sum;
    for (int i = 0; i < ticks; ++i) {
      tick(target);
      sum.left_mm_s += plant_.truth().left_mm_s;
      sum.right_mm_s += plant_.truth().right_mm_s;
    }
    return {sum.left_mm_s / ticks, sum.right_mm_s / ticks};
  }

  const WheelLoop& loop() const { return loop_; }
  WheelLoop& loop() { return loop_; }
  const Plant& plant() const { return plant_; }
  Plant& plant() { return plant_; }
  Axes reads() const { return reads_; }
  WheelSpeeds command() const { return command_; }

 private:
  Plant plant_;
  WheelLoop loop_;
  WheelSpeeds command_{};
  Axes reads_ = kBothAxes;
  int off_mm_ = 0;
};

TEST(WheelLoop, TakesTheDroopAwayOnBothKindsOfRobot) {
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    const double most = remainder == Remainder::carried ? 1.5 : 5.0;
    for (const WheelSpeeds& target : {WheelSpeeds{60, 60}, WheelSpeeds{200, 200},
                                      WheelSpeeds{-350, -350}, WheelSpeeds{-150, 150}}) {
      ClosedLoop closed{{.remainder = remainder}};
      closed.run(target, 100);
      const WheelSpeeds mean = closed.mean_over(target, 400);
      EXPECT_NEAR(mean.left_mm_s, target.left_mm_s, most);
      EXPECT_NEAR(mean.right_mm_s, target.right_mm_s, most);
    }
  }
}

// One that a robot could just have driven, if it had turned around at once.
TEST(WheelLoop, EndsNoDriveForASingleWildReading) {
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    ClosedLoop closed{{.remainder = remainder}};
    closed.run({45, 45}, 300);
    for (int i = 0; i < 100; ++i) closed.tick({45, 45}, i == 0 ? -44 : 0);
    EXPECT_EQ(closed.loop().evidence().what, WheelWatch::Finding::nothing);
  }
}

// Once a reading has missed, it does not wait for another long window to be sure.
TEST(WheelLoop, ReadsAgainSoonWhereALoadSeemsToHaveChanged) {
  ClosedLoop closed{{.remainder = Remainder::lost, .noise_mm_s = 0.0}};
  closed.run({180, 180}, 600);
  closed.plant().parameters().gain_left *= 0.75;
  closed.plant().parameters().gain_right *= 0.75;
  std::vector<int> read_at;
  for (int tick = 1; tick <= 60; ++tick) {
    closed.tick({180, 180});
    if (closed.reads().distance) read_at.push_back(tick);
  }
  ASSERT_GE(read_at.size(), 4U);
  EXPECT_LE(read_at[2], 24) << "of which the first two may be of before";
  EXPECT_LE(read_at[3] - read_at[2], 6);
}

TEST(WheelLoop, SendsTheSetSpeedAsItIsWhereTheLoopIsOpen) {
  ClosedLoop open{{}, {.feedback = WheelLoop::Feedback::open}};
  open.run({200, 200}, 200);
  EXPECT_EQ(open.command(), (WheelSpeeds{200, 200}));
  EXPECT_LT(open.plant().truth().right_mm_s, 185.0) << "10 % short";
}

TEST(WheelLoop, CommandsWholeSpeedsWithinTheRobotsRange) {
  ClosedLoop closed{{}};
  for (int tick = 0; tick < 2000; ++tick) {
    const double target = tick % 200 < 100 ? 500.0 : -500.0;
    closed.tick({target, -target});
    for (const double speed : {closed.command().left_mm_s, closed.command().right_mm_s}) {
      ASSERT_EQ(speed, std::round(speed));
      ASSERT_LE(std::abs(speed), 500.0);
    }
  }
}

TEST(WheelLoop, CommandsExactlyZeroOnceTheSetSpeedIsZero) {
  for (const double target : {200.0, -333.0, 500.0}) {
    ClosedLoop closed{{}};
    closed.run({target, target}, 200);
    closed.run({}, 34);  // 500 mm/s at 1000 mm/s^2: 34 ticks
    EXPECT_EQ(closed.command(), WheelSpeeds{});
    closed.run({}, 67);
    EXPECT_EQ(closed.command(), WheelSpeeds{}) << "and nothing creeps";
    EXPECT_EQ(closed.loop().set(), WheelSpeeds{});
    EXPECT_NEAR(closed.loop().estimate().left_mm_s, 0.0, 2.0);
  }
}

TEST(WheelLoop, LimitsTheAcceleration) {
  ClosedLoop closed{{}, {.limits = {.acceleration_mm_s2 = 400.0}}};
  WheelSpeeds former;
  for (int tick = 0; tick < 300; ++tick) {
    closed.tick(tick < 150 ? WheelSpeeds{300, -300} : WheelSpeeds{-300, 300});
    const WheelSpeeds set = closed.loop().set();
    ASSERT_LE(std::abs(set.left_mm_s - former.left_mm_s), 6.0 + 1e-9);
    ASSERT_LE(std::abs(set.right_mm_s - former.right_mm_s), 6.0 + 1e-9);
    former = set;
  }
}

// Both wheels by one factor: at most what the weaker one can reach.
TEST(WheelLoop, KeepsTheCurveBeyondTheReachOfAWheel) {
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    for (const WheelSpeeds& target :
         {WheelSpeeds{480, 480}, WheelSpeeds{300, 500}, WheelSpeeds{-500, 420}}) {
      ClosedLoop closed{{.remainder = remainder, .noise_mm_s = 0.0}};
      closed.run(target, 200);
      EXPECT_TRUE(closed.loop().limited().speed);
      const WheelSpeeds mean = closed.mean_over(target, 300);
      const double fast = std::max(std::abs(target.left_mm_s), std::abs(target.right_mm_s));
      const double part = std::max(std::abs(mean.left_mm_s), std::abs(mean.right_mm_s)) / fast;
      EXPECT_NEAR(mean.left_mm_s, part * target.left_mm_s, 0.01 * fast);
      EXPECT_NEAR(mean.right_mm_s, part * target.right_mm_s, 0.01 * fast);
      EXPECT_GT(part, 0.85) << "not slower than need be";
    }
  }
}

TEST(WheelLoop, SaysWhatLimitsIt) {
  ClosedLoop closed{{}};
  closed.tick({200, 200});
  EXPECT_EQ(closed.loop().limited(), (WheelLoop::Limited{.acceleration = true}));
  closed.run({200, 200}, 30);
  EXPECT_EQ(closed.loop().limited(), WheelLoop::Limited{});
  closed.run({500, 500}, 200);
  EXPECT_TRUE(closed.loop().limited().speed);
  EXPECT_EQ(closed.loop().set(), (WheelSpeeds{500, 500}));
  EXPECT_LT(closed.loop().given().left_mm_s, 470.0);
  EXPECT_EQ(closed.loop().given().left_mm_s, closed.loop().given().right_mm_s);
  closed.run({}, 10);
  EXPECT_EQ(closed.loop().limited(), (WheelLoop::Limited{.acceleration = true}));
}

// A set speed just within reach, with a gain that is not: a minute of it must not be felt later.
TEST(WheelLoop, DoesNotWindUpAtTheLimit) {
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    for (const double sign : {1.0, -1.0}) {
      ClosedLoop closed{
          {.remainder = remainder, .gain_left = 0.9, .gain_right = 0.9, .noise_mm_s = 0.0}};
      closed.run({sign * 480.0, sign * 480.0}, 4000);
      EXPECT_NEAR(closed.command().left_mm_s, sign * 492.5, 7.5) << "with room to correct it";
      EXPECT_NEAR(closed.plant().truth().left_mm_s, sign * 443.0, 7.0);
      closed.run({sign * 300.0, sign * 300.0}, 67);  // 1 s
      EXPECT_NEAR(closed.plant().truth().left_mm_s, sign * 300.0, 10.0);
      EXPECT_NEAR(closed.plant().truth().right_mm_s, sign * 300.0, 10.0);
    }
  }
}

// What was learnt going forward must not spoil the way back.
TEST(WheelLoop, SettlesSoonAfterAReversal) {
  ClosedLoop closed{{.noise_mm_s = 0.0}};
  closed.run({300, 300}, 300);
  double worst = 0.0;
  for (int tick = 0; tick < 150; ++tick) {
    closed.tick({-300, -300});
    if (tick >= 60 + 30)
      worst = std::max(worst, std::abs(closed.plant().truth().right_mm_s + 300.0));
  }
  EXPECT_LT(worst, 15.0) << "half a second behind the ramp";
}

TEST(WheelLoop, GoesOnFromTheFormerCommandWhereOneWasNotSent) {
  ClosedLoop closed{{}};
  closed.run({200, 200}, 100);
  const WheelSpeeds former = closed.loop().command();
  (void)closed.loop().control({250, 250});
  closed.loop().not_sent(former);
  EXPECT_EQ(closed.loop().command(), former);
}

TEST(WheelLoop, StartsFromStandingAfterAStop) {
  ClosedLoop closed{{}};
  closed.run({300, 300}, 200);
  closed.loop().stop();
  EXPECT_EQ(closed.loop().command(), WheelSpeeds{});
  EXPECT_EQ(closed.loop().set(), WheelSpeeds{});
  const WheelSpeeds next = closed.loop().control({300, 300});
  EXPECT_EQ(closed.loop().set().left_mm_s, 15.0) << "by the acceleration limit";
  EXPECT_LT(next.left_mm_s, 150.0);
}

// Given up, yet here a moment later: each tick counts once.
TEST(WheelLoop, CountsATickOnceWhoseFrameComesAfterAll) {
  ClosedLoop waited{{}};
  waited.run({200, 200}, 200);
  WheelLoop gave_up = waited.loop();
  gave_up.lost(3, {});
  gave_up.came_after_all(3);
  for (int frame = 0; frame < 5; ++frame) {
    waited.loop().frame({});
    gave_up.frame({});
  }
  EXPECT_EQ(gave_up.estimate(), waited.loop().estimate());
}

TEST(WheelLoop, SurvivesALongSilence) {
  ClosedLoop closed{{}};
  closed.run({200, 200}, 200);
  closed.loop().lost(1'000'000, kBothAxes);  // bounded, and therefore quick
  closed.run({200, 200}, 200);
  EXPECT_NEAR(closed.mean_over({200, 200}, 200).left_mm_s, 200.0, 1.5);
}

// Recorded readings and targets give the same commands again, bit for bit.
TEST(WheelLoop, CanBeReplayed) {
  struct Step {
    WheelEstimator::Reading reading;
    WheelSpeeds target;
    WheelSpeeds command;
  };
  std::vector<Step> recorded;
  Plant plant{{.remainder = Remainder::lost}};
  WheelLoop loop{{}};
  WheelSpeeds command;
  Axes reads = kBothAxes;
  for (int tick = 0; tick < 1000; ++tick) {
    plant.tick(command);
    const WheelEstimator::Reading reading = plant.read(reads);
    const WheelSpeeds target{tick % 300 < 150 ? 180.0 : -90.0, 120.0};
    loop.frame(reading);
    command = loop.control(target);
    reads = loop.next_reads();
    recorded.push_back({reading, target, command});
  }
  WheelLoop again{{}};
  for (const Step& step : recorded) {
    again.frame(step.reading);
    ASSERT_EQ(again.control(step.target), step.command);
    (void)again.next_reads();
  }
  EXPECT_EQ(again.estimate(), loop.estimate());
}

}  // namespace
}  // namespace cargobay::rt
