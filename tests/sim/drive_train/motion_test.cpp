#include "hal/sim/drive_train/motion.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/random.hpp"

namespace cargobay::hal::sim {
namespace {

struct Place {
  double speed_mm_s = 0.0;
  double travel_mm = 0.0;
};

// The differential equation by Runge and Kutta, to compare with the closed form.
Place integrated(const Motion& motion, double time_s) {
  const int steps = 4000;
  const double step_s = time_s / steps;
  const auto slope = [&motion](double at_s, double speed_mm_s) {
    return (motion.target_mm_s + motion.slope_mm_s2 * at_s - speed_mm_s) / motion.lag_s;
  };
  Place place{.speed_mm_s = motion.speed_mm_s};
  for (int i = 0; i < steps; ++i) {
    const double at_s = i * step_s;
    const double v = place.speed_mm_s;
    const double k1 = slope(at_s, v);
    const double k2 = slope(at_s + 0.5 * step_s, v + 0.5 * step_s * k1);
    const double k3 = slope(at_s + 0.5 * step_s, v + 0.5 * step_s * k2);
    const double k4 = slope(at_s + step_s, v + step_s * k3);
    place.travel_mm += step_s * (v + step_s * (k1 + k2 + k3) / 6.0);
    place.speed_mm_s += step_s * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
  }
  return place;
}

std::vector<Motion> motions() {
  Random random{11};
  std::vector<Motion> all;
  for (int i = 0; i < 60; ++i) {
    const auto within = [&random](double most) { return most * (2.0 * random.uniform() - 1.0); };
    all.push_back({.speed_mm_s = within(400.0),
                   .target_mm_s = within(400.0),
                   .slope_mm_s2 = i % 3 == 0 ? 0.0 : within(1500.0),
                   .lag_s = 0.03 + 0.4 * random.uniform()});
  }
  return all;
}

TEST(Motion, SolvesItsDifferentialEquation) {
  for (const Motion& motion : motions()) {
    for (const double time_s : {0.01, 0.2, 0.7}) {
      const Place place = integrated(motion, time_s);
      EXPECT_NEAR(motion.speed_after(time_s), place.speed_mm_s, 1e-6);
      EXPECT_NEAR(motion.travel_after(5.0, time_s), 5.0 + place.travel_mm, 1e-5);
    }
  }
}

// By looking at each of a thousand instants.
TEST(Motion, FindsItsFirstReversal) {
  constexpr double kWithinS = 1.0;
  int found = 0;
  for (const Motion& motion : motions()) {
    double seen_s = Motion::kNever;
    for (int i = 1; i <= 1000 && seen_s == Motion::kNever; ++i) {
      if (motion.speed_after(i * 1e-3) * motion.speed_mm_s < 0.0) seen_s = i * 1e-3;
    }
    const double reversal_s = motion.reversal(kWithinS);
    if (seen_s == Motion::kNever) {
      EXPECT_EQ(reversal_s, Motion::kNever);
      continue;
    }
    ++found;
    EXPECT_NEAR(reversal_s, seen_s - 0.5e-3, 0.5e-3 + 1e-12);
    EXPECT_NEAR(motion.speed_after(reversal_s), 0.0, 1e-9);
  }
  EXPECT_GT(found, 15);
}

// Down through 0 and up again, between two instants at which it goes forward.
TEST(Motion, FindsAReversalThatItTakesBack) {
  const Motion motion{
      .speed_mm_s = 50.0, .target_mm_s = -150.0, .slope_mm_s2 = 1000.0, .lag_s = 0.05};
  EXPECT_GT(motion.speed_after(0.5), 0.0);
  const double reversal_s = motion.reversal(0.5);
  ASSERT_LT(reversal_s, 0.1);
  EXPECT_NEAR(motion.speed_after(reversal_s), 0.0, 1e-9);
  EXPECT_LT(motion.speed_after(reversal_s + 0.01), 0.0);
}

}  // namespace
}  // namespace cargobay::hal::sim
