#include "rt/turn_observer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr double kTick = 0.015;
constexpr double kDegreeMm = 4.5;

struct Robot {
  double gain_left = 0.92;
  double gain_right = 0.92;
  double step_mm_s = 0.0;   // in which commands act
  double noise_mm_s = 1.4;  // of the wheels' difference, for 0.15 s in one sense
};

// A robot at a constant lag, whose angle is read and loses its remainder.
class Turns {
 public:
  Turns(const Robot& robot, std::uint64_t seed) : robot_{robot}, random_{seed} {
    observer_.reset({.gain_difference = 0.0, .gain_difference_sd = 0.09});
  }
  void run(const WheelSpeeds& driven, int ticks) {
    const auto acts = [this](double speed_mm_s) {
      return robot_.step_mm_s > 0.0 ? robot_.step_mm_s * std::round(speed_mm_s / robot_.step_mm_s)
                                    : speed_mm_s;
    };
    const double keep = std::exp(-kTick / 0.15);
    for (int i = 0; i < ticks; ++i) {
      noise_mm_s_ = keep * noise_mm_s_ + std::sqrt(1.0 - keep * keep) * robot_.noise_mm_s *
                                             std::normal_distribution<double>{}(random_);
      const double wanted = robot_.gain_right * acts(driven.right_mm_s) -
                            robot_.gain_left * acts(driven.left_mm_s) + noise_mm_s_;
      const double way_mm =
          response_.position_by_speed * speed_mm_s_ + response_.position_by_input * wanted;
      speed_mm_s_ = response_.speed_by_speed * speed_mm_s_ + response_.speed_by_input * wanted;
      true_mm_ += way_mm;
      counted_mm_ += way_mm;
      observer_.step({.wheels = driven, .gain = 0.92}, response_, {});
    }
  }
  int read() {
    const int count = static_cast<int>(counted_mm_ / kDegreeMm);
    counted_mm_ = 0.0;
    observer_.read(count);
    return count;
  }
  double error_mm() const { return observer_.turn_mm() - true_mm_; }
  double sd_mm() const { return std::sqrt(observer_.turn_variance()); }
  double true_mm() const { return true_mm_; }
  TurnObserver& observer() { return observer_; }

 private:
  Robot robot_;
  std::mt19937_64 random_;
  TurnObserver observer_{{.step_mm = kDegreeMm, .tick_s = kTick}};
  AxisFilter::Response response_ = AxisFilter::response(0.1, kTick);
  double noise_mm_s_ = 0.0;
  double speed_mm_s_ = 0.0;
  double true_mm_ = 0.0;
  double counted_mm_ = 0.0;
};

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST(TurnObserver, StandsUntilItIsDriven) {
  Turns turns{{.noise_mm_s = 0.0}, 1};
  turns.run({}, 1000);
  EXPECT_EQ(turns.observer().turn_mm(), 0.0);
  EXPECT_EQ(turns.observer().unread_mm(), 0.0);
}

// The gains differ by 5 %: what was foreseen before the first reading was wrong, and it says so.
TEST(TurnObserver, LearnsTheDifferenceOfTheGainsFromAReading) {
  Turns turns{{.gain_left = 0.90, .gain_right = 0.945, .noise_mm_s = 0.0}, 1};
  turns.run({200, 200}, 100);
  EXPECT_LT(turns.error_mm(), -10.0);
  EXPECT_EQ(turns.read(), 2);
  EXPECT_NEAR(turns.error_mm(), 0.0, kDegreeMm);
  turns.run({200, 200}, 400);
  EXPECT_LT(std::abs(turns.error_mm()), 0.35 * 54.0) << "of the 54 mm of these six seconds";
  turns.read();
  turns.run({200, 200}, 400);
  EXPECT_NEAR(turns.error_mm(), 0.0, 1.5 * kDegreeMm);
}

// Truths and foreseen errors: many robots, some of whose commands act in steps.
TEST(TurnObserver, KnowsHowFarItMayBeWrong) {
  for (const double step_mm_s : {0.0, 8.5, 28.5}) {
    std::vector<double> share;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
      std::mt19937_64 random{seed};
      std::uniform_real_distribution<double> gain{0.86, 0.98};
      Turns turns{{.gain_left = gain(random), .gain_right = gain(random), .step_mm_s = step_mm_s},
                  seed};
      for (int i = 0; i < 10; ++i) {
        turns.run({200.0 + static_cast<double>(i % 3), 203.0 - static_cast<double>(i % 5)}, 100);
        turns.read();
      }
      share.push_back(std::abs(turns.error_mm()) / turns.sd_mm());
    }
    EXPECT_LE(quantile(share, 0.95), 2.6) << step_mm_s;
    EXPECT_GE(quantile(share, 0.5), 0.3) << step_mm_s << ": not wider than it must be";
  }
}

// What a small change of the command does to such a robot is nothing, or a whole step.
TEST(TurnObserver, FindsOutThatCommandsActInSteps) {
  std::vector<double> off;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Turns turns{{.step_mm_s = 28.5}, seed};
    for (int i = 0; i < 10; ++i) {
      turns.run(i % 2 == 0 ? WheelSpeeds{195, 205} : WheelSpeeds{188, 212}, 100);
      turns.read();
    }
    const double before = turns.true_mm();
    turns.run({195, 205}, 200);
    EXPECT_LT(std::abs(turns.true_mm() - before), 10.0) << "both act as 199.5";
    off.push_back(std::abs(turns.error_mm()));
  }
  EXPECT_LE(quantile(off, 0.9), 12.0) << "27 mm, by commands that act as they are";
}

TEST(TurnObserver, KeepsWhatItHasTurnedWhenItIsFollowedAgain) {
  Turns turns{{}, 1};
  turns.run({100, 200}, 100);
  turns.read();
  const double turned = turns.observer().turn_mm();
  EXPECT_GT(turned, 100.0);
  turns.observer().resume({.gain_difference = 0.0, .gain_difference_sd = 0.01}, 90.0, 4.0);
  EXPECT_NEAR(turns.observer().turn_mm(), turned, 1e-9);
  EXPECT_EQ(turns.observer().speed_mm_s(), 90.0);
}

TEST(TurnObserver, ForgetsNothingOfAReadingThatWasNotSeen) {
  Turns turns{{}, 1};
  turns.run({100, 200}, 100);
  const double turned = turns.observer().turn_mm();
  const double variance = turns.observer().turn_variance();
  turns.observer().read_unseen();
  EXPECT_DOUBLE_EQ(turns.observer().turn_mm(), turned);
  EXPECT_NEAR(turns.observer().turn_variance(), variance, 1e-6 * variance);
  EXPECT_EQ(turns.observer().unread_mm(), 0.0);
}

}  // namespace
}  // namespace cargobay::rt
