// The wheel loop on plants that nobody tuned it for. Its kind of remainder is told; nothing else.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "rt/wheel_loop.hpp"
#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

using test::any_plant;
using test::Plant;
using test::PlantParameters;

constexpr std::array kWheels{&WheelSpeeds::left_mm_s, &WheelSpeeds::right_mm_s};

class ClosedLoop {
 public:
  explicit ClosedLoop(const PlantParameters& plant)
      : plant_{plant}, loop_{{.estimator = {.remainder = plant.remainder}}} {
    run({}, 20);
  }

  void tick(const WheelSpeeds& target) {
    plant_.tick(loop_.command());
    loop_.frame(plant_.read(reads_));
    loop_.control(target);
    reads_ = loop_.next_reads();
  }
  void run(const WheelSpeeds& target, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(target);
  }
  // Starts, turns, slows down, reverses, within what the plant's motors can do.
  void drive_about(unsigned seed, double seconds) {
    std::mt19937 random{seed};
    std::uniform_real_distribution<double> speed{60.0, 250.0};
    std::uniform_real_distribution<double> part{0.4, 1.0};
    for (int ticks = 0; ticks < seconds / Plant::kTick;) {
      const double fast = (random() % 3 == 0 ? -1.0 : 1.0) * speed(random);
      const double slow = part(random) * fast;
      const int length = 30 + static_cast<int>(random() % 80);
      run(random() % 2 == 0 ? WheelSpeeds{fast, slow} : WheelSpeeds{slow, fast}, length);
      ticks += length;
    }
  }

  Plant& plant() { return plant_; }
  const WheelLoop& loop() const { return loop_; }

 private:
  Plant plant_;
  WheelLoop loop_;
  Axes reads_ = kBothAxes;
};

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(share * last))];
}
void tell(const char* what, const std::vector<double>& values) {
  std::printf("%s: median %.3g, p90 %.3g, p95 %.3g, p99 %.3g, worst %.3g of %zu\n", what,
              quantile(values, 0.5), quantile(values, 0.9), quantile(values, 0.95),
              quantile(values, 0.99), quantile(values, 1.0), values.size());
}

// How far off still counts as there: 5 %, or 3 mm/s, and a step that the plant cannot go between.
double near_enough(const PlantParameters& plant, double set_mm_s) {
  return std::max(0.05 * set_mm_s, 3.0) + plant.step_mm_s;
}

// The first step, from standing.
struct Step {
  double overshoot_mm_s = 0.0;
  double settled_s = 0.0;
};
template <typename Tick>
Step first_step(const PlantParameters& plant, double set_mm_s, const Tick& tick) {
  Step step;
  for (int i = 1; i <= 500; ++i) {
    const WheelSpeeds truth = tick();
    for (const auto wheel : kWheels) {
      step.overshoot_mm_s = std::max(step.overshoot_mm_s, truth.*wheel - set_mm_s);
      if (std::abs(truth.*wheel - set_mm_s) > near_enough(plant, set_mm_s)) {
        step.settled_s = i * Plant::kTick;
      }
    }
  }
  return step;
}
// What the same plant does if it is told, by the same ramp, the command that is right in the end.
Step oracle_step(const PlantParameters& parameters, double set_mm_s) {
  Plant plant{parameters};
  SlewLimiter slew{SlewLimiter::Limits{}};
  WheelSpeeds command;
  return first_step(parameters, set_mm_s, [&] {
    plant.tick(command);
    const WheelSpeeds set = slew.step({set_mm_s, set_mm_s}, Plant::kTick);
    command = {std::round(set.left_mm_s / parameters.gain_left),
               std::round(set.right_mm_s / parameters.gain_right)};
    return plant.truth();
  });
}

class AnyPlant : public testing::TestWithParam<Remainder> {
 protected:
  static bool carried() { return GetParam() == Remainder::carried; }
};
INSTANTIATE_TEST_SUITE_P(WheelLoop, AnyPlant, testing::Values(Remainder::carried, Remainder::lost),
                         [](const auto& tested) {
                           return tested.param == Remainder::carried ? "Carried" : "Lost";
                         });

TEST_P(AnyPlant, TakesTheFirstStepAsItShould) {
  std::vector<double> over;  // mm/s beyond what is allowed
  std::vector<double> late;  // s after what is allowed
  for (unsigned seed = 1; seed <= 200; ++seed) {
    PlantParameters plant = any_plant(seed, GetParam());
    plant.noise_mm_s = 0.1;
    std::mt19937 random{seed};
    const double set_mm_s = std::uniform_real_distribution<double>{40.0, 280.0}(random);
    ClosedLoop closed{plant};
    const Step step = first_step(plant, set_mm_s, [&] {
      closed.tick({set_mm_s, set_mm_s});
      return closed.plant().truth();
    });
    over.push_back(step.overshoot_mm_s - (std::max(0.06 * set_mm_s, 10.0) + plant.step_mm_s));
    late.push_back(step.settled_s -
                   (1.2 * oracle_step(plant, set_mm_s).settled_s + (carried() ? 0.5 : 0.9)));
  }
  tell("overshoot beyond the bound, mm/s", over);
  tell("settled after the bound, s", late);
  EXPECT_LE(quantile(over, 0.95), carried() ? 0.0 : 3.0);
  EXPECT_LE(quantile(over, 0.99), 9.0);
  EXPECT_LE(quantile(late, 0.90), 0.0);
  EXPECT_LE(quantile(late, 0.95), carried() ? 0.15 : 0.8);
}

TEST_P(AnyPlant, IsRightInTheEnd) {
  std::vector<double> errors;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    PlantParameters plant = any_plant(seed, GetParam());
    plant.step_mm_s = 0.0;
    plant.noise_mm_s = 0.2;
    ClosedLoop closed{plant};
    closed.drive_about(seed, 10.0);
    closed.run({160, 160}, 200);
    WheelSpeeds sum;
    for (int i = 0; i < 200; ++i) {
      closed.tick({160, 160});
      for (const auto wheel : kWheels) sum.*wheel += closed.plant().truth().*wheel / 200.0;
    }
    for (const auto wheel : kWheels) errors.push_back(std::abs(sum.*wheel - 160.0));
  }
  tell("steady error, mm/s", errors);
  EXPECT_LE(quantile(errors, 0.95), carried() ? 1.5 : 5.0);
}

// A quarter more of friction, at once, on our own robot.
TEST_P(AnyPlant, ComesBackAfterALoadStep) {
  std::vector<double> back_s;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    ClosedLoop closed{{.remainder = GetParam(), .seed = seed, .noise_mm_s = 0.5}};
    closed.drive_about(seed, 6.0);
    closed.run({180, 180}, 200 + static_cast<int>(seed % 40));
    closed.plant().parameters().gain_left *= 0.75;
    closed.plant().parameters().gain_right *= 0.75;
    double back = 0.0;
    for (int i = 1; i <= 267; ++i) {
      closed.tick({180, 180});
      for (const auto wheel : kWheels) {
        if (std::abs(closed.plant().truth().*wheel - 180.0) > 9.0) back = i * Plant::kTick;
      }
    }
    back_s.push_back(back);
  }
  tell("back after a load step, s", back_s);
  EXPECT_LE(quantile(back_s, 0.95), carried() ? 0.82 : 1.0);
}

TEST_P(AnyPlant, NeverRunsAwayFromCountersThatStayZero) {
  std::vector<double> beyond;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    for (const double set_mm_s : {30.0, 100.0, 250.0}) {
      PlantParameters plant = any_plant(seed, GetParam());
      plant.noise_mm_s = 0.0;
      plant.counts = seed % 2 == 0;  // from the start, or from somewhere on the way
      ClosedLoop closed{plant};
      if (plant.counts) closed.drive_about(seed, 3.0);
      closed.run({}, 200);
      closed.plant().parameters().counts = false;
      double fastest = 0.0;
      for (int i = 0; i < 300; ++i) {
        closed.tick({set_mm_s, set_mm_s});
        for (const auto wheel : kWheels) {
          fastest = std::max(fastest, std::abs(closed.plant().truth().*wheel));
        }
      }
      // A command acts as the nearest whole step, and is a whole number itself.
      const double rounding = 1.15 * (plant.step_mm_s / 2.0 + 0.5);
      beyond.push_back(fastest - (1.7 * set_mm_s + 50.0 + rounding));
    }
  }
  tell("beyond 1.7 x set + 50 mm/s", beyond);
  EXPECT_LE(quantile(beyond, 1.0), 0.0);
}

// Neither to brake nor to reverse: its counter would run backwards.
TEST_P(AnyPlant, NeverStopsByACommandAgainstTheWayItRolls) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    ClosedLoop closed{any_plant(seed, GetParam())};
    closed.drive_about(seed, 3.0);
    for (const double sign : {1.0, -1.0}) {
      closed.run({sign * 200.0, sign * 150.0}, 150);
      for (int i = 0; i < 150; ++i) {
        closed.tick({});
        for (const auto wheel : kWheels) {
          ASSERT_GE(sign * closed.loop().command().*wheel, 0.0) << "seed " << seed << ", " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace cargobay::rt
