#include "rt/course.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr double kTick = 0.015;

// Wheels that do at once what they are asked for, but for what pushes them.
class Wheels {
 public:
  explicit Wheels(const Course::Parameters& parameters = {}) : course_{parameters} {}

  void run(const WheelSpeeds& target, int ticks, const WheelSpeeds& push_mm_s = {}) {
    for (int i = 0; i < ticks; ++i) {
      if (kept_ == WheelSpeeds{}) kept_ = step(target);  // from standing
      now_ = {kept_.left_mm_s + push_mm_s.left_mm_s, kept_.right_mm_s + push_mm_s.right_mm_s};
      way_.left_mm_s += kTick * now_.left_mm_s;
      way_.right_mm_s += kTick * now_.right_mm_s;
      aside_mm_ += kTick * (now_.left_mm_s + now_.right_mm_s) / 2.0 * std::sin(turn());
      kept_ = step(target);
    }
  }
  double turn() const { return (way_.right_mm_s - way_.left_mm_s) / 258.0; }
  double aside_mm() const { return aside_mm_; }
  const WheelSpeeds& kept() const { return kept_; }

 private:
  WheelSpeeds step(const WheelSpeeds& target) {
    return course_.step(target, target, now_, {.if_carried = way_, .if_lost = way_},
                        {.carried = 0.3, .gains = true}, kTick);
  }

  Course course_;
  WheelSpeeds way_{};
  WheelSpeeds now_{};
  WheelSpeeds kept_{};
  double aside_mm_ = 0.0;
};

// As wheels of unlike gain do while that is learnt: half a second, 20 mm/s apart.
constexpr WheelSpeeds kPush{-10.0, 10.0};
constexpr int kPushed = 33;

TEST(Course, LeavesSpeedsAloneThatAreKept) {
  Wheels wheels;
  wheels.run({200, 150}, 500);
  EXPECT_NEAR(wheels.kept().left_mm_s, 200.0, 1e-9);
  EXPECT_NEAR(wheels.kept().right_mm_s, 150.0, 1e-9);
}

TEST(Course, TakesBackTheTurnOfTheStartAndWhatItWentAsideForIt) {
  Wheels wheels;
  wheels.run({200, 200}, kPushed, kPush);
  EXPECT_GT(wheels.turn(), 0.03);
  wheels.run({200, 200}, 2000);
  EXPECT_NEAR(wheels.turn(), 0.0, 0.002);
  EXPECT_NEAR(wheels.aside_mm(), 0.0, 3.0) << "without it, 230 mm";
}

// Wheels 5 mm/s apart are back sooner than their error by itself would have them.
TEST(Course, HurriesIfMuchIsToBeTakenBack) {
  Wheels wheels;
  wheels.run({200, 200}, 2 * kPushed, kPush);
  EXPECT_GT(wheels.kept().left_mm_s, 203.0);
  wheels.run({200, 200}, 67 * 4);
  EXPECT_LT(wheels.turn(), 0.025) << "0.045 by a share of the speed alone";
}

WheelSpeeds kept_with(const Course::Known& known, const WheelSpeeds& now) {
  Course course{{}};
  const WheelSpeeds asked{200, 200};
  (void)course.step(asked, asked, {}, {}, known, kTick);
  const WheelSpeeds ways{-6.0, 6.0};
  return course.step(asked, asked, now, {.if_carried = ways, .if_lost = ways}, known, kTick);
}

// As after a load step: a wheel that is far from its set speed is to come there first.
TEST(Course, DoesNotHurryWhileTheWheelsAreNotSettled) {
  const Course::Known known{.carried = 1.0, .gains = true};
  const double settled = kept_with(known, {200, 200}).left_mm_s - 200.0;
  EXPECT_GT(settled, 3.0);
  EXPECT_LT(kept_with(known, {200, 150}).left_mm_s - 200.0, settled / 2.0);
  EXPECT_LT(kept_with(known, {208, 200}).left_mm_s - 200.0, settled / 2.0);
  EXPECT_LT(kept_with({.carried = 1.0}, {200, 200}).left_mm_s - 200.0, settled / 2.0)
      << "the gains are not known";
}

// What was foreseen since the reading before was wrong, and so is where the robot is.
TEST(Course, TakesBackWhatItWentAsideBeforeAReading) {
  const auto back = [](double corrected_mm) {
    Course course{{.hold_heading = true}};
    const WheelSpeeds asked{200, 200};
    constexpr Course::Known kLoses{.carried = 0.0, .gains = true};
    WheelSpeeds way{};
    const auto go = [&](double more_mm) {
      way = {way.left_mm_s + 3.0, way.right_mm_s + 3.0 + more_mm};
      return course.step(asked, asked, asked, {.if_lost = way, .corrected_mm = more_mm}, kLoses,
                         kTick);
    };
    for (int i = 0; i < 300; ++i) (void)go(0.0);
    return go(corrected_mm).left_mm_s - 200.0;
  };
  EXPECT_EQ(back(0.0), 0.0);
  EXPECT_NEAR(back(2.0), 1.45, 0.05) << "1.0 for the turn, 0.45 for 900 mm on which it came about";
}

TEST(Course, DoesThatWithinWhatIsCalledSettled) {
  Wheels wheels;
  wheels.run({200, 200}, 2 * kPushed, {-40.0, 40.0});
  EXPECT_NEAR(wheels.kept().right_mm_s, 200.0, 0.04 * 200.0);
  EXPECT_NE(wheels.kept().right_mm_s, 200.0);
  EXPECT_NEAR(wheels.kept().left_mm_s + wheels.kept().right_mm_s, 400.0, 1e-9);
}

// A bend of 1 m: the ratio of the wheels is the curve.
TEST(Course, KeepsACurve) {
  Wheels wheels;
  wheels.run({250, 150}, kPushed, kPush);
  wheels.run({250, 150}, 1500);
  const double ticks = kPushed + 1500;
  EXPECT_NEAR(wheels.turn(), -100.0 / 258.0 * (ticks - 1.0) * kTick, 0.01);
}

TEST(Course, ForgetsItWithAnotherCurve) {
  Wheels wheels;
  wheels.run({200, 200}, kPushed, kPush);
  wheels.run({200, 180}, 1);
  EXPECT_EQ(wheels.kept(), (WheelSpeeds{200, 180}));
  Wheels stopped;
  stopped.run({200, 200}, kPushed, kPush);
  stopped.run({}, 10);
  stopped.run({200, 200}, 1);
  EXPECT_EQ(stopped.kept(), (WheelSpeeds{200, 200}));
}

// The same curve at another speed is the same.
TEST(Course, RemembersItWhileOnlyTheSpeedChanges) {
  Wheels wheels;
  wheels.run({200, 200}, kPushed, kPush);
  wheels.run({100, 100}, 2000);
  EXPECT_NEAR(wheels.turn(), 0.0, 0.005);
}

// Until the wheels have come to it: what they go in between, nobody asked them to take back.
TEST(Course, BeginsWhenTheWheelsHaveComeToTheCurve) {
  Wheels wheels;
  wheels.run({200, 100}, 100);
  const double before = wheels.turn();
  wheels.run({200, 200}, 20, {50.0, -50.0});
  wheels.run({200, 200}, 1);
  EXPECT_EQ(wheels.kept(), (WheelSpeeds{200, 200}));
  wheels.run({200, 200}, 500);
  EXPECT_LT(wheels.turn(), before - 0.05);
}

TEST(Course, HoldsTheHeadingAcrossStopsAndOtherCurves) {
  Wheels wheels{{.hold_heading = true}};
  wheels.run({200, 200}, kPushed, kPush);
  wheels.run({}, 10);
  wheels.run({200, 200}, 1000);
  EXPECT_NEAR(wheels.turn(), 0.0, 0.002);
  wheels.run({-50, 50}, 200, kPush);
  wheels.run({200, 200}, 1000);
  EXPECT_NEAR(wheels.turn(), 100.0 / 258.0 * 200.0 * kTick, 0.01);
}

TEST(Course, MovesNoWheelThatIsToStand) {
  Wheels wheels{{.hold_heading = true}};
  wheels.run({0, 200}, kPushed, {0, 10});
  EXPECT_EQ(wheels.kept().left_mm_s, 0.0);
}

}  // namespace
}  // namespace cargobay::rt
