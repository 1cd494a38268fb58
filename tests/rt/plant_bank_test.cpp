#include "rt/plant_bank.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

using test::Plant;
using test::PlantParameters;

RemainderBelief belief_in(Remainder remainder) {
  return remainder == Remainder::carried ? RemainderBelief::carried : RemainderBelief::lost;
}

// A bank that watches a plant: every tick if it carries the remainder, else every tenth.
class Watch {
 public:
  explicit Watch(const PlantParameters& plant, const PlantBank::Parameters& bank = {})
      : plant_{plant}, bank_{bank} {}

  void tick(const WheelSpeeds& command) {
    plant_.tick(command_);
    bank_.step(command_);
    const int window = plant_.parameters().remainder == Remainder::carried ? 1 : 10;
    if (++since_read_ >= window) read();
    command_ = command;
  }
  void run(const WheelSpeeds& command, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(command);
  }
  // Starts, turns, slows down, reverses.
  void drive_about(unsigned seed, double seconds) {
    std::mt19937 random{seed};
    std::uniform_real_distribution<double> speed{60.0, 300.0};
    std::uniform_real_distribution<double> part{0.3, 1.0};
    for (int ticks = 0; ticks < seconds / Plant::kTick;) {
      const double fast = (random() % 3 == 0 ? -1.0 : 1.0) * speed(random);
      const double slow = part(random) * fast;
      const int length = 20 + static_cast<int>(random() % 60);
      run(random() % 2 == 0 ? WheelSpeeds{fast, slow} : WheelSpeeds{slow, fast}, length);
      ticks += length;
    }
  }

  const PlantEstimate& estimate() const { return bank_.estimate(); }
  Plant& plant() { return plant_; }
  void read_no_more_angles() { reads_angles_ = false; }
  PlantBank& bank() { return bank_; }

 private:
  void read() {
    const auto reading = plant_.read();
    const auto belief = belief_in(plant_.parameters().remainder);
    bank_.read(Axis::distance, *reading.distance_mm, since_read_, belief, plant_.truth());
    if (reads_angles_)
      bank_.read(Axis::turn, *reading.angle_deg, since_read_, belief, plant_.truth());
    bank_.conclude();
    since_read_ = 0;
  }

  Plant plant_;
  PlantBank bank_;
  WheelSpeeds command_{};
  int since_read_ = 0;
  bool reads_angles_ = true;
};

PlantEstimate known(double lag_s, double dead_time_s, double ramp_s2_mm) {
  return {.lag_s = lag_s,
          .dead_time_s = dead_time_s,
          .ramp_s2_mm = ramp_s2_mm,
          .gain_left = 0.8,
          .gain_right = 0.7};
}

// The mean of each tick of a step that acts a dead time, and a part of a tick, later.
TEST(PlantBank, WaitsForTheDeadTimeToAPartOfATick) {
  for (const double dead_time_s : {0.0, 0.004, 0.0125, 0.020, 0.0475, 0.075}) {
    PlantBank bank{{.told = known(0.1, dead_time_s, 0.0)}};
    for (int tick = 0; tick < 10; ++tick) {
      bank.step({200.0, -100.0});
      const double acts_from = (0.0025 + dead_time_s) / Plant::kTick;
      const double part = std::clamp(tick + 1 - acts_from, 0.0, 1.0);
      EXPECT_NEAR(bank.driven().left_mm_s, 200.0 * part, 1e-3) << dead_time_s << ' ' << tick;
      EXPECT_NEAR(bank.driven().right_mm_s, -100.0 * part, 1e-3) << dead_time_s << ' ' << tick;
    }
  }
}

TEST(PlantBank, RampsWhatTheWheelsAreDrivenAt) {
  constexpr double kRamp = 400.0;
  PlantBank bank{{.input_delay_s = 0.0, .told = known(0.1, 0.0, 1.0 / kRamp)}};
  for (int tick = 0; tick < 60; ++tick) {
    bank.step({200.0, -100.0});
    const double middle = kRamp * Plant::kTick * (tick + 0.5);
    // A ramp may end within a tick.
    const double slack = kRamp * Plant::kTick / 2.0 + 1e-3;
    EXPECT_NEAR(bank.driven().left_mm_s, std::min(200.0, middle), middle < 195.0 ? 1e-3 : slack);
    EXPECT_NEAR(bank.driven().right_mm_s, -std::min(100.0, middle), middle < 95.0 ? 1e-3 : slack);
  }
}

TEST(PlantBank, LearnsNothingWhereItIsTold) {
  const PlantEstimate told = known(0.3, 0.03, 1.0 / 500.0);
  Watch watch{{}, {.told = told}};
  watch.drive_about(1, 10.0);
  const PlantEstimate& after = watch.estimate();
  EXPECT_NEAR(after.lag_s, told.lag_s, 1e-6);
  EXPECT_NEAR(after.dead_time_s, told.dead_time_s, 1e-6);
  EXPECT_NEAR(after.ramp_s2_mm, told.ramp_s2_mm, 1e-8);
  EXPECT_NEAR(after.gain_left, 0.8, 1e-6);
  EXPECT_NEAR(after.gain_right, 0.7, 1e-6);
  EXPECT_NEAR(after.gain_sd, 0.0, 1e-4);
  EXPECT_NEAR(after.lag_sd_s, 0.0, 1e-3);
}

class PlantBankOfBothKinds : public testing::TestWithParam<Remainder> {};
INSTANTIATE_TEST_SUITE_P(PlantBank, PlantBankOfBothKinds,
                         testing::Values(Remainder::carried, Remainder::lost),
                         [](const auto& tested) {
                           return tested.param == Remainder::carried ? "Carried" : "Lost";
                         });

// A distance tells the mean of both wheels; how they share it follows from what a load is.
TEST_P(PlantBankOfBothKinds, TakesALoadForTheSamePartOfBothGains) {
  Watch watch{{.remainder = GetParam(), .gain_left = 0.70, .gain_right = 0.95, .noise_mm_s = 0.0}};
  watch.drive_about(3, 20.0);
  watch.run({200, 200}, 200);
  const PlantEstimate before = watch.estimate();
  watch.plant().parameters().gain_left *= 0.75;
  watch.plant().parameters().gain_right *= 0.75;
  watch.read_no_more_angles();
  watch.run({200, 200}, 130);
  const PlantEstimate& after = watch.estimate();
  EXPECT_NEAR(after.gain_left + after.gain_right, 0.75 * 1.65, 0.03);
  EXPECT_NEAR(after.gain_left / after.gain_right, before.gain_left / before.gain_right, 0.015);
}

// Plants of its grid, after half a minute: the mean of the gains, and lag and dead time to a step.
TEST_P(PlantBankOfBothKinds, LearnsExactPlants) {
  const bool carried = GetParam() == Remainder::carried;
  for (const double lag_s : {0.035, 0.100, 0.250}) {
    for (const double dead_time_s : {0.0, 0.035, 0.070}) {
      for (const double ramp_mm_s2 : {1e9, 500.0}) {
        for (const auto& [left, right] : {std::pair{0.94, 0.90}, std::pair{0.65, 0.75}}) {
          Watch watch{{.remainder = GetParam(),
                       .gain_left = left,
                       .gain_right = right,
                       .noise_mm_s = 0.0,
                       .lag_s = lag_s,
                       .dead_time_s = dead_time_s,
                       .ramp_mm_s2 = ramp_mm_s2}};
          watch.drive_about(3, 30.0);
          const PlantEstimate& found = watch.estimate();
          const auto which = testing::Message() << lag_s << " s, " << dead_time_s << " s, "
                                                << ramp_mm_s2 << " mm/s^2, " << left;
          EXPECT_NEAR(found.gain_left + found.gain_right, left + right, 0.05) << which;
          EXPECT_NEAR(found.gain_left, left, 0.065) << which;
          EXPECT_NEAR(found.gain_right, right, 0.065) << which;
          const double delay_s = lag_s + dead_time_s;
          EXPECT_NEAR(found.lag_s + found.dead_time_s, delay_s, carried ? 0.027 : 0.040) << which;
          EXPECT_NEAR(found.lag_s, lag_s, carried ? 0.02 : 0.05) << which;
          EXPECT_NEAR(found.dead_time_s, dead_time_s, carried ? 0.026 : 0.030) << which;
          EXPECT_NEAR(found.ramp_s2_mm, ramp_mm_s2 < 1e6 ? 1.0 / ramp_mm_s2 : 0.0, 0.0006) << which;
        }
      }
    }
  }
}

TEST_P(PlantBankOfBothKinds, KnowsTheGainBetterAndBetter) {
  Watch watch{{.remainder = GetParam(), .noise_mm_s = 0.0}};
  EXPECT_NEAR(watch.estimate().gain_sd, 0.2, 0.02);
  for (const double most : {0.1, 0.03, 0.015}) {
    watch.drive_about(7, 2.0);
    EXPECT_LT(watch.estimate().gain_sd, most);
  }
}

// Such a load is on the gains; the motors have not become slower or quicker.
TEST_P(PlantBankOfBothKinds, TakesALoadForAGain) {
  for (const double load : {0.75, 1.2}) {
    Watch watch{{.remainder = GetParam(), .noise_mm_s = 0.0}};
    watch.drive_about(5, 15.0);
    watch.run({180, 180}, 200);
    const PlantEstimate before = watch.estimate();
    watch.plant().parameters().gain_left *= load;
    watch.plant().parameters().gain_right *= load;
    watch.run({180, 180}, 100);
    const PlantEstimate& after = watch.estimate();
    EXPECT_NEAR(after.gain_left, load * 0.94, 0.03) << load;
    EXPECT_NEAR(after.gain_right, load * 0.90, 0.03) << load;
    EXPECT_NEAR(after.lag_s, before.lag_s, 0.35 * before.lag_s) << load;
    EXPECT_NEAR(after.dead_time_s, before.dead_time_s, 0.010) << load;
  }
}

// However long there is nothing to learn.
TEST_P(PlantBankOfBothKinds, ForgetsNothingWhileItStandsOrDrivesSteadily) {
  for (const WheelSpeeds command : {WheelSpeeds{}, {180.0, 180.0}}) {
    Watch watch{{.remainder = GetParam(), .noise_mm_s = 0.0, .lag_s = 0.250}};
    watch.drive_about(5, 60.0);
    watch.run(command, 200);
    const PlantEstimate before = watch.estimate();
    ASSERT_NEAR(before.lag_s, 0.250, 0.05);
    watch.run(command, 40'000);  // ten minutes
    EXPECT_NEAR(watch.estimate().lag_s, before.lag_s, 0.01) << command.left_mm_s;
    EXPECT_NEAR(watch.estimate().gain_left, before.gain_left, 0.03) << command.left_mm_s;
  }
}

// Long after it was sure of another: every model has kept a small share.
TEST_P(PlantBankOfBothKinds, FindsAPlantThatHasChanged) {
  Watch watch{{.remainder = GetParam(), .noise_mm_s = 0.0}};
  watch.drive_about(5, 120.0);
  ASSERT_NEAR(watch.estimate().lag_s, 0.100, 0.030);
  watch.plant().parameters().lag_s = 0.250;
  watch.plant().parameters().gain_left = 0.70;
  watch.drive_about(6, 20.0);
  EXPECT_NEAR(watch.estimate().lag_s, 0.250, 0.05);
  EXPECT_NEAR(watch.estimate().gain_left, 0.70, 0.05);
}

TEST_P(PlantBankOfBothKinds, ForgetsTheWayOfAReadingThatWasNotSeen) {
  Watch watch{{.remainder = GetParam(), .noise_mm_s = 0.0}};
  watch.drive_about(5, 10.0);
  watch.run({180, 180}, 50);
  const PlantEstimate before = watch.estimate();
  for (int tick = 0; tick < 15; ++tick) {  // some readings go by
    watch.plant().tick({180, 180});
    watch.bank().step({180, 180});
  }
  (void)watch.plant().read();
  for (const Axis axis : {Axis::distance, Axis::turn}) watch.bank().read_unseen(axis);
  watch.run({180, 180}, 30);
  EXPECT_NEAR(watch.estimate().gain_left, before.gain_left, 0.02);
  EXPECT_NEAR(watch.estimate().lag_s, before.lag_s, 0.01);
  EXPECT_LT(watch.estimate().gain_sd, 0.05) << "no misfit";
}

TEST_P(PlantBankOfBothKinds, BeginsAgainAfterAReset) {
  Watch watch{{.remainder = GetParam(), .lag_s = 0.3}};
  watch.drive_about(5, 10.0);
  watch.bank().reset();
  PlantBank fresh{{}};
  const auto same = [&] {
    const PlantEstimate& one = watch.bank().estimate();
    const PlantEstimate& other = fresh.estimate();
    return one.lag_s == other.lag_s && one.dead_time_s == other.dead_time_s &&
           one.ramp_s2_mm == other.ramp_s2_mm && one.gain_left == other.gain_left &&
           one.gain_sd == other.gain_sd && one.lag_sd_s == other.lag_sd_s &&
           watch.bank().driven() == fresh.driven();
  };
  EXPECT_TRUE(same());
  for (PlantBank* bank : {&watch.bank(), &fresh}) {
    for (int tick = 0; tick < 40; ++tick) {
      bank->step({150, 100});
      bank->read(Axis::distance, tick % 3, 1, belief_in(GetParam()), {150, 100});
      bank->conclude();
    }
  }
  EXPECT_TRUE(same());
}

LearntPlant prior_of(double lag_s, double gain) {
  return {.lag_s = lag_s,
          .lag_sd_s = 0.01,
          .dead_time_sd_s = 0.01,
          .ramp_sd_s2_mm = 1e-4,
          .gain_left = gain,
          .gain_left_sd = 0.01,
          .gain_right = gain,
          .gain_right_sd = 0.01};
}

// It moves the mean, and the mean only so far that nothing is taken for known.
TEST(PlantBankWithPrior, BeginsBetweenIt) {
  PlantBank bank{{}};
  const PlantEstimate without = bank.estimate();
  bank.begin_from(prior_of(0.360, 0.70));
  EXPECT_GT(bank.estimate().lag_s, without.lag_s);
  EXPECT_LT(bank.estimate().lag_s, 0.360);
  EXPECT_LT(bank.estimate().gain_left, without.gain_left);
  EXPECT_GT(bank.estimate().gain_left, 0.70);
  EXPECT_GT(bank.estimate().gain_sd, 0.1);
  EXPECT_GT(bank.estimate().lag_sd_s, 0.05);
}

TEST(PlantBankWithPrior, KnowsSoonerWhatItHasDrivenBefore) {
  PlantParameters plant;
  plant.lag_s = 0.300;
  plant.gain_left = 0.70;
  plant.gain_right = 0.66;
  Watch first{plant};
  first.drive_about(3, 20.0);
  Watch again{plant};
  again.bank().begin_from(first.bank().learnt());
  Watch fresh{plant};
  for (Watch* watch : {&again, &fresh}) watch->run({200, 200}, 25);
  EXPECT_LT(std::abs(again.estimate().gain_left - plant.gain_left), 0.05);
  EXPECT_LT(again.estimate().gain_sd, fresh.estimate().gain_sd);
  EXPECT_LT(std::abs(again.estimate().lag_s - plant.lag_s), 0.07);
  EXPECT_LT(again.estimate().lag_sd_s, fresh.estimate().lag_sd_s);
}

TEST(PlantBankWithPrior, GetsOverAWrongOne) {
  PlantParameters plant;
  plant.lag_s = 0.060;
  plant.gain_left = plant.gain_right = 1.1;
  Watch watch{plant};
  watch.bank().begin_from(prior_of(0.500, 0.60));
  watch.drive_about(5, 5.0);
  EXPECT_NEAR(watch.estimate().gain_left, 1.1, 0.03);
  EXPECT_NEAR(watch.estimate().gain_right, 1.1, 0.03);
  EXPECT_NEAR(watch.estimate().lag_s, 0.060, 0.02);
}

TEST(PlantBankWithPrior, DoesNotDependOnOneThatNoModelIsLike) {
  PlantBank bank{{}};
  const PlantEstimate without = bank.estimate();
  LearntPlant far = prior_of(0.100, 0.9);
  far.dead_time_s = 5.0;
  bank.begin_from(far);
  EXPECT_EQ(bank.estimate().lag_s, without.lag_s);
  EXPECT_EQ(bank.estimate().gain_left, without.gain_left);
}

TEST(PlantBankWithPrior, StatesEverySpread) {
  Watch watch{{}};
  const LearntPlant before = watch.bank().learnt();
  watch.drive_about(7, 20.0);
  const LearntPlant after = watch.bank().learnt();
  for (const auto spread :
       {&LearntPlant::lag_sd_s, &LearntPlant::dead_time_sd_s, &LearntPlant::ramp_sd_s2_mm,
        &LearntPlant::gain_left_sd, &LearntPlant::gain_right_sd}) {
    EXPECT_GT(before.*spread, 0.0);
    EXPECT_LT(after.*spread, 0.6 * before.*spread);
  }
  EXPECT_EQ(after.lag_s, watch.estimate().lag_s);
  EXPECT_EQ(after.gain_right, watch.estimate().gain_right);
}

}  // namespace
}  // namespace cargobay::rt
