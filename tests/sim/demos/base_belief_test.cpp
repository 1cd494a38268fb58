// Where a Home Base may stand, by what was seen of it.
#include "hal/sim/demos/base_belief.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hal/sim/world/world.hpp"

namespace cargobay::hal::sim {
namespace {

constexpr double kStepMm = 4.0;  // between two looks

constexpr double kHalfTurnRad = std::numbers::pi;

// A base at the origin that looks along x, in a room without walls.
struct Believing {
  World world{};
  BaseBelief belief{};

  Believing() { world.home_base = Beam{}; }
  oi::HomeBaseBeams light(double x_mm, double y_mm) const {
    Inputs seen;
    world.sense({x_mm, y_mm, 0.0}, seen);
    return seen.beams();
  }
  void drive(double x_mm, double y_mm, double to_x_mm, double to_y_mm) {
    const double far_mm = std::hypot(to_x_mm - x_mm, to_y_mm - y_mm);
    const int steps = static_cast<int>(std::ceil(far_mm / kStepMm));
    for (int step = 0; step < steps; ++step) {
      const double part = step * kStepMm / far_mm;
      const double at_x_mm = x_mm + part * (to_x_mm - x_mm);
      const double at_y_mm = y_mm + part * (to_y_mm - y_mm);
      belief.see(at_x_mm, at_y_mm, light(at_x_mm, at_y_mm));
    }
  }
};

void expect_at_origin(const BaseBelief& belief, double most_mm) {
  const auto base = belief.estimate();
  ASSERT_TRUE(base);
  EXPECT_NEAR(base->x_mm, 0.0, most_mm);
  EXPECT_NEAR(base->y_mm, 0.0, most_mm);
  EXPECT_NEAR(std::remainder(base->heading_rad, 2.0 * kHalfTurnRad), 0.0, 0.2);
}

TEST(BaseBelief, KnowsNothingBeforeItSawALight) {
  Believing robot;
  EXPECT_FALSE(robot.belief.estimate());
  robot.drive(3000, 3000, 3000, 0);
  EXPECT_FALSE(robot.belief.estimate());
}

TEST(BaseBelief, DoesNotChooseAmongPlacesThatAgree) {
  Believing robot;
  robot.drive(900, 400, 800, 400);
  EXPECT_FALSE(robot.belief.estimate());
}

TEST(BaseBelief, FindsTheBaseByTwoWaysAcrossItsLight) {
  Believing robot;
  robot.drive(1000, 1200, 1000, -1200);
  robot.drive(1000, -1200, 450, 600);
  expect_at_origin(robot.belief, 120.0);
}

TEST(BaseBelief, FindsTheBaseFromWithinItsRedLight) {
  Believing robot;
  robot.drive(200, 900, 900, 200);
  robot.drive(900, 200, 300, 150);
  robot.drive(300, 150, 200, 900);
  expect_at_origin(robot.belief, 150.0);
}

TEST(BaseBelief, ForgetsAll) {
  Believing robot;
  robot.drive(1000, 1200, 1000, -1200);
  robot.drive(1000, -1200, 450, 600);
  robot.belief.forget();
  EXPECT_FALSE(robot.belief.estimate());
}

// Moved to another place, it is found there: what was seen long ago counts no longer.
TEST(BaseBelief, FollowsABaseThatIsMoved) {
  Believing robot;
  robot.drive(1000, 1200, 1000, -1200);
  robot.drive(1000, -1200, 450, 600);
  const auto drives_beside = [&robot](double x_mm, double y_mm, double to_x_mm, double to_y_mm) {
    const double far_mm = std::hypot(to_x_mm - x_mm, to_y_mm - y_mm);
    const int steps = static_cast<int>(std::ceil(far_mm / kStepMm));
    for (int step = 0; step < steps; ++step) {
      const double part = step * kStepMm / far_mm;
      const double at_x_mm = x_mm + part * (to_x_mm - x_mm);
      const double at_y_mm = y_mm + part * (to_y_mm - y_mm);
      robot.belief.see(at_x_mm + 400.0, at_y_mm, robot.light(at_x_mm, at_y_mm));
    }
  };
  for (int i = 0; i < 4; ++i) {
    drives_beside(1000, 900, 1000, -900);
    drives_beside(1000, -900, 450, 600);
  }
  const auto base = robot.belief.estimate();
  ASSERT_TRUE(base);
  EXPECT_NEAR(base->x_mm, 400.0, 120.0);
}

}  // namespace
}  // namespace cargobay::hal::sim
