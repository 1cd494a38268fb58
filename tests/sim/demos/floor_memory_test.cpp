// What a demo remembers of the floor, and the ways that this leaves open.
#include "hal/sim/demos/floor_memory.hpp"

#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "hal/sim/demos/demo_view.hpp"

namespace cargobay::hal::sim {
namespace {

// On an endless floor, by its encoders.
struct Remembering {
  Inputs seen{};
  DemoView view{.seen = &seen};
  FloorMemory floor{};

  explicit Remembering(FloorMemory::Beams beams = FloorMemory::Beams::close) {
    floor.reset(view, beams);
  }
  void drive(double mm) {
    constexpr int kSteps = 100;
    for (int i = 0; i < kSteps; ++i) {
      view.travelled_mm += mm / kSteps;
      floor.watch(view);
    }
  }
  void turn(double deg) {
    view.turned_deg += deg;
    floor.watch(view);
  }
  // Into something straight ahead, and back.
  void bump() {
    seen.bump_left = seen.bump_right = true;
    floor.watch(view);
    seen.bump_left = seen.bump_right = false;
    drive(-100.0);
  }
  double away_mm(FloorMemory::Place place) const {
    return std::hypot(place.x_mm - floor.here().x_mm, place.y_mm - floor.here().y_mm);
  }
};

TEST(FloorMemory, ReckonsWhereTheRobotIs) {
  Remembering robot;
  robot.drive(1000.0);
  robot.turn(90.0);
  robot.drive(500.0);
  EXPECT_NEAR(robot.floor.here().x_mm, 1000.0, 1.0);
  EXPECT_NEAR(robot.floor.here().y_mm, 500.0, 1.0);
  EXPECT_NEAR(robot.floor.way_mm(), 1500.0, 1.0);
}

TEST(FloorMemory, DoesNotCountTheWayOfWheelsThatSlip) {
  Remembering robot;
  robot.drive(400.0);
  robot.seen.bump_left = robot.seen.bump_right = true;
  robot.drive(200.0);
  EXPECT_NEAR(robot.floor.here().x_mm, 420.0, 1.0);
}

TEST(FloorMemory, CountsTheWayAlongWhatOneSideTouches) {
  Remembering robot;
  robot.seen.bump_left = true;
  robot.drive(100.0);
  EXPECT_NEAR(robot.floor.here().x_mm, 60.0, 1.0);
  EXPECT_NEAR(robot.floor.here().y_mm, -36.0, 1.0);
  robot.seen.bump_left = false;
  robot.seen.bump_right = true;
  robot.drive(100.0);
  EXPECT_NEAR(robot.floor.here().y_mm, 0.0, 1.0);
  robot.drive(-100.0);  // away from it: nothing holds it
  EXPECT_NEAR(robot.floor.here().x_mm, 20.0, 1.0);
  EXPECT_NEAR(robot.floor.here().y_mm, 0.0, 1.0);
}

TEST(FloorMemory, LeadsToPlacesThatAreNew) {
  Remembering robot;
  robot.drive(1000.0);
  for (const auto how :
       {FloorMemory::Fresh::far, FloorMemory::Fresh::near, FloorMemory::Fresh::uncovered}) {
    EXPECT_FALSE(robot.floor.is_fresh({.x_mm = 500.0}, how));
    const auto place = robot.floor.toward_fresh(how);
    ASSERT_TRUE(place);
    EXPECT_FALSE(robot.floor.is_old());
    EXPECT_LT(robot.away_mm(*place), 800.0);
  }
  EXPECT_TRUE(robot.floor.is_fresh({.x_mm = 500.0, .y_mm = 400.0}, FloorMemory::Fresh::near));
  EXPECT_FALSE(robot.floor.is_fresh({.x_mm = 500.0, .y_mm = 400.0}, FloorMemory::Fresh::far));
}

TEST(FloorMemory, LeadsAroundWhatItMet) {
  Remembering robot;
  robot.drive(500.0);
  const FloorMemory::Place beyond{.x_mm = 1300.0};
  EXPECT_TRUE(robot.floor.open_line(robot.floor.here(), beyond));
  robot.bump();
  EXPECT_FALSE(robot.floor.open_line(robot.floor.here(), beyond));
  const auto leg = robot.floor.toward(beyond);
  ASSERT_TRUE(leg);
  EXPECT_GT(std::abs(leg->y_mm), 150.0) << "past it";
  EXPECT_TRUE(robot.floor.open_line(robot.floor.here(), *leg));
}

// Its reckoning was wrong: it has not been there.
TEST(FloorMemory, BelievesABumpRatherThanThatItPassedThere) {
  Remembering robot;
  robot.drive(700.0);
  robot.drive(-400.0);
  EXPECT_TRUE(robot.floor.open_line(robot.floor.here(), {.x_mm = 700.0}));
  robot.seen.bump_left = robot.seen.bump_right = true;
  robot.floor.watch(robot.view);
  robot.seen.bump_left = robot.seen.bump_right = false;
  EXPECT_FALSE(robot.floor.open_line(robot.floor.here(), {.x_mm = 700.0}));
}

// A wall across the way, except for 190 mm on either side of it.
TEST(FloorMemory, TriesANarrowGapIfNoOtherWayLeadsThere) {
  Remembering robot;
  for (const double side : {90.0, -90.0}) {
    robot.turn(side);
    robot.drive(140.0);
    for (int i = 0; i < 140; ++i) {
      robot.drive(50.0);
      robot.turn(-side);
      robot.seen.bump_left = robot.seen.bump_right = true;
      robot.floor.watch(robot.view);
      robot.seen.bump_left = robot.seen.bump_right = false;
      robot.turn(side);
    }
    robot.drive(-140.0 - 140 * 50.0);
    robot.turn(-side);
  }
  const FloorMemory::Place beyond{.x_mm = 1000.0};
  EXPECT_FALSE(robot.floor.toward(beyond, FloorMemory::Care::wide));
  EXPECT_TRUE(robot.floor.toward(beyond, FloorMemory::Care::narrow));
}

TEST(FloorMemory, KeepsFartherFromACliff) {
  Remembering robot;
  robot.drive(500.0);
  robot.seen.cliff_front_left.cliff = true;
  robot.floor.watch(robot.view);
  robot.seen.cliff_front_left.cliff = false;
  robot.drive(-200.0);
  EXPECT_FALSE(robot.floor.open_line({.x_mm = 650.0, .y_mm = -600.0}, {.x_mm = 650.0}));
}

TEST(FloorMemory, ClosesABeamUnlessItLeads) {
  for (const auto beams : {FloorMemory::Beams::close, FloorMemory::Beams::lead}) {
    Remembering robot{beams};
    robot.drive(500.0);
    robot.seen.virtual_wall = true;
    robot.floor.watch(robot.view);
    robot.seen.virtual_wall = false;
    robot.drive(-300.0);
    EXPECT_EQ(robot.floor.open_line(robot.floor.here(), {.x_mm = 1000.0}),
              beams == FloorMemory::Beams::lead);
  }
}

// The force field of a Home Base trips the same sensor.
TEST(FloorMemory, DoesNotTakeAForceFieldForABeam) {
  Remembering robot;
  robot.seen.virtual_wall = true;
  robot.seen.infrared = 242;
  robot.drive(500.0);
  robot.drive(-500.0);
  EXPECT_TRUE(robot.floor.open_line(robot.floor.here(), {.x_mm = 1000.0}));
}

TEST(FloorMemory, KnowsWhereItFollowedAWall) {
  Remembering robot;
  robot.drive(300.0);
  robot.floor.follow_here();
  robot.drive(-300.0);
  EXPECT_TRUE(robot.floor.followed(300.0));
  EXPECT_FALSE(robot.floor.followed(600.0));
}

TEST(FloorMemory, KnowsWhetherItIsInTheOpen) {
  Remembering robot;
  robot.drive(600.0);
  EXPECT_TRUE(robot.floor.roomy(500.0));
  robot.bump();
  EXPECT_FALSE(robot.floor.roomy(250.0));
}

TEST(FloorMemory, ForgetsTheFloorButNotWhereItIs) {
  Remembering robot;
  robot.drive(500.0);
  robot.bump();
  robot.floor.forget();
  EXPECT_TRUE(robot.floor.open_line(robot.floor.here(), {.x_mm = 1300.0}));
  EXPECT_TRUE(robot.floor.is_fresh({.x_mm = 200.0}, FloorMemory::Fresh::uncovered));
  EXPECT_NEAR(robot.floor.here().x_mm, 400.0, 1.0);
}

TEST(FloorMemory, HasNoWayFromBeyondItsMap) {
  Remembering robot;
  robot.drive(8000.0);
  EXPECT_FALSE(robot.floor.toward_fresh(FloorMemory::Fresh::far));
  EXPECT_FALSE(robot.floor.toward({.x_mm = 9000.0}));
}

TEST(MeanPlace, IsThatOfAllPlaces) {
  MeanPlace mean;
  mean.add({.x_mm = 100.0, .y_mm = -50.0});
  mean.add({.x_mm = 300.0, .y_mm = 50.0});
  EXPECT_NEAR(mean.at.x_mm, 200.0, 1e-9);
  EXPECT_NEAR(mean.at.y_mm, 0.0, 1e-9);
}

// What makes the reckoning true: the encoders of a robot that coasts count the wrong way.
TEST(Evasion, StandsBeforeItTurnsTheOtherWay) {
  Inputs seen;
  DemoView view{.seen = &seen, .travelled_mm = 1000.0};
  Evasion evasion;
  evasion.start(view, 60.0, 90.0);
  WheelSpeeds wheels{};
  const auto coast = [&](double mm) {  // a tick later
    view.now += std::chrono::milliseconds{15};
    view.travelled_mm += mm;
    return evasion.step(view, wheels);
  };
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(coast(3.0));
    EXPECT_EQ(wheels, WheelSpeeds{}) << "while it coasts";
  }
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(coast(0.0));
  EXPECT_LT(wheels.left_mm_s, 0.0) << "back, once it stands";
  for (int i = 0; i < 11; ++i) ASSERT_TRUE(coast(-6.0));
  EXPECT_EQ(wheels, WheelSpeeds{}) << "far enough";
  ASSERT_TRUE(coast(-6.0));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(coast(0.0));
  EXPECT_LT(wheels.left_mm_s, 0.0);
  EXPECT_GT(wheels.right_mm_s, 0.0) << "and turns";
}

TEST(Evasion, BacksOffFromACliffAtOnce) {
  Inputs seen;
  DemoView view{.seen = &seen, .travelled_mm = 1000.0};
  seen.cliff_front_left.cliff = true;
  Evasion evasion;
  evasion.start(view, 60.0, -90.0);
  WheelSpeeds wheels{};
  ASSERT_TRUE(evasion.step(view, wheels));
  EXPECT_LT(wheels.left_mm_s, 0.0);
  EXPECT_LT(wheels.right_mm_s, 0.0);
}

TEST(Evasion, StandsBeforeItDrivesOn) {
  Inputs seen;
  DemoView view{.seen = &seen, .travelled_mm = 1000.0};
  Evasion evasion;
  evasion.start(view, 0.0, 90.0);
  WheelSpeeds wheels{};
  const auto tick = [&](double deg) {
    view.now += std::chrono::milliseconds{15};
    view.turned_deg += deg;
    return evasion.step(view, wheels);
  };
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(tick(0.0));
  EXPECT_LT(wheels.left_mm_s, 0.0) << "it turns";
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(tick(10.0));
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(tick(2.0));
    EXPECT_EQ(wheels, WheelSpeeds{}) << "while it coasts";
  }
  ASSERT_TRUE(tick(0.0));
  bool active = true;
  for (int i = 0; i < 5 && active; ++i) active = tick(0.0);
  EXPECT_FALSE(active);
}

// Turning further would bring a wheel over it.
struct TurningToACliff : testing::Test {
  Inputs seen{};
  DemoView view{.seen = &seen, .travelled_mm = 1000.0};
  Evasion evasion{};
  WheelSpeeds wheels{};

  bool tick(double deg) {
    view.now += std::chrono::milliseconds{15};
    view.turned_deg += deg;
    return evasion.step(view, wheels);
  }
  void SetUp() override {
    evasion.start(view, 0.0, 90.0);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(tick(0.0));
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(tick(2.0));
    seen.cliff_left.cliff = true;
    ASSERT_TRUE(tick(2.0));
    EXPECT_EQ(wheels, WheelSpeeds{});
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(tick(0.0));
    EXPECT_GT(wheels.left_mm_s, 0.0) << "to the right";
    seen.cliff_left.cliff = false;
  }
};

TEST_F(TurningToACliff, GetsToItsHeadingTheOtherWayRound) {
  for (int i = 0; i < 145; ++i) {
    ASSERT_TRUE(tick(-2.0));
    EXPECT_GT(wheels.left_mm_s, 0.0);
  }
  bool active = true;
  for (int i = 0; i < 10 && active; ++i) active = tick(i < 2 ? -2.0 : 0.0);
  EXPECT_FALSE(active);
  EXPECT_NEAR(view.turned_deg, 90.0 - 360.0, 3.0);
}

TEST_F(TurningToACliff, TurnsBackIfItMeetsOneThatWayToo) {
  for (int i = 0; i < 31; ++i) ASSERT_TRUE(tick(-2.0));
  seen.cliff_right.cliff = true;
  ASSERT_TRUE(tick(-2.0));
  EXPECT_EQ(wheels, WheelSpeeds{});
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(tick(0.0));
  EXPECT_LT(wheels.left_mm_s, 0.0) << "to the left again";
  seen.cliff_right.cliff = false;
  for (int i = 0; i < 21; ++i) ASSERT_TRUE(tick(2.0));
  EXPECT_NEAR(view.turned_deg, 0.0, 3.0);
  EXPECT_LT(wheels.left_mm_s, 0.0) << "and back the way it came";
  EXPECT_LT(wheels.right_mm_s, 0.0);
}

}  // namespace
}  // namespace cargobay::hal::sim
