#include "hal/sim/world/world.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "hal/sim/world/world_drawing.hpp"
#include "tests/sim/robot.hpp"
#include "tests/sim/world/world_of.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

WorldPose at(double x_mm, double y_mm, double heading_deg) {
  return {x_mm, y_mm, heading_deg * std::numbers::pi / 180.0};
}

Inputs seen_from(const World& world, const WorldPose& pose) {
  Inputs inputs;
  world.sense(pose, inputs);
  return inputs;
}

TEST(World, HoldsTheRobotAtAWall) {
  const World world = world_of("wall 1000 -1000 1000 1000\nstart 0 0 0\n");
  Robot robot{ideal_wheels()};
  inhabit(robot.device, world);
  robot.send({128, 132, 145, 1, 44, 1, 44});
  robot.wait(5s);
  EXPECT_NEAR(robot.device.truth().pose.x_mm, 1000.0 - 165.0, 5.0);
  EXPECT_EQ(robot.ask({142, 7}), (Bytes{0b11}));
  EXPECT_GT(word(robot.ask({142, 19}), 0), 1400) << "the encoders count the slip";
  robot.send({145, 0xff, 0x38, 0xff, 0x38});
  robot.wait(200ms);
  EXPECT_EQ(robot.ask({142, 7}), (Bytes{0}));
}

TEST(World, BumpsTheSideThatTouches) {
  const World world = world_of("post 300 0 50\n");
  const auto bumps = [&world](double heading_deg) {
    const auto contact = world.collide(at(100, 0, heading_deg));
    return std::pair{contact && contact->left, contact && contact->right};
  };
  EXPECT_EQ(bumps(0), (std::pair{true, true}));
  EXPECT_EQ(bumps(-45), (std::pair{true, false})) << "the post is to the left";
  EXPECT_EQ(bumps(45), (std::pair{false, true}));
  EXPECT_EQ(bumps(180), (std::pair{false, false})) << "there is no bumper behind";
  EXPECT_TRUE(world.collide(at(100, 0, 180))) << "but it is held";
}

TEST(World, HasOtherRobotsInTheWay) {
  const World world;
  const std::array others{Body{.pose = at(320, 0, 0)}};
  const auto contact = world.collide(at(0, 0, 0), others);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->centre.x_mm, -10.0, 1e-9) << "pushed back until they touch";
  EXPECT_TRUE(contact->left && contact->right);
  const auto leaning = world.collide(at(-10.5, 0, 0), others);
  ASSERT_TRUE(leaning) << "its bumper is still pushed";
  EXPECT_EQ(leaning->centre.x_mm, -10.5) << "it stays where it is";
  EXPECT_FALSE(world.collide(at(-12, 0, 0), others));
}

TEST(World, HidesWhatIsBehindAnotherRobot) {
  const World world = world_of("virtual-wall 0 0 0\nhome-base 3000 0 180\n");
  const auto seen = [&world](std::span<const Body> others) {
    Inputs inputs;
    world.sense(at(1600, 0, 0), inputs, kAllAroundDeg, others);
    return inputs;
  };
  EXPECT_TRUE(seen({}).virtual_wall);
  EXPECT_TRUE(seen({}).beams().any());
  const std::array before{Body{.pose = at(800, 0, 0)}};
  EXPECT_FALSE(seen(before).virtual_wall);
  const std::array behind{Body{.pose = at(2300, 0, 0)}};
  EXPECT_FALSE(seen(behind).beams().any());
  const std::array on_the_right{Body{.pose = at(1730, -300, 0)}};
  EXPECT_TRUE(seen(on_the_right).wall) << "the wall sensor sees it";
}

TEST(World, TwoRobotsHoldEachOther) {
  const World world = world_of("start 0 0 0\nstart 1000 0 180\n");
  Bodies bodies;
  Robot first{ideal_wheels()};
  Robot second{ideal_wheels()};
  const std::size_t numbers[]{bodies.enter(), bodies.enter()};
  inhabit(first.device, world, bodies, numbers[0]);
  inhabit(second.device, world, bodies, numbers[1]);
  first.send({128, 132, 145, 1, 44, 1, 44});
  second.send({128, 132, 145, 0, 100, 0, 100});
  for (int i = 0; i < 1000; ++i) {
    first.wait(5ms);
    second.wait(5ms);
  }
  const double apart_mm = second.device.truth().pose.x_mm - first.device.truth().pose.x_mm;
  EXPECT_NEAR(apart_mm, 330.0, 10.0);
  EXPECT_EQ(first.ask({142, 7}), (Bytes{0b11}));
  EXPECT_EQ(second.ask({142, 7}), (Bytes{0b11}));
  bodies.leave(numbers[1]);
  first.wait(1s);
  EXPECT_EQ(first.ask({142, 7}), (Bytes{0})) << "the other has left";
  EXPECT_EQ(bodies.enter(), numbers[1]);
}

TEST(World, HoldsTheRobotInACorner) {
  const World world = world_of("wall 0 0 1000 0\nwall 0 0 0 1000\n");
  const auto contact = world.collide(at(100, 100, 225));
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->centre.x_mm, 165.0, 1e-6);
  EXPECT_NEAR(contact->centre.y_mm, 165.0, 1e-6);
}

TEST(World, SlidesAlongAWall) {
  const World world = world_of("wall -5000 165 5000 165\n");
  Robot robot{ideal_wheels()};
  inhabit(robot.device, world);
  robot.device.place(at(0, 0, 20));
  robot.send({128, 132, 145, 0, 200, 0, 200});
  robot.wait(5s);
  EXPECT_NEAR(robot.device.truth().pose.x_mm, 1000.0 * std::cos(20.0 * std::numbers::pi / 180.0),
              10.0);
  EXPECT_NEAR(robot.device.truth().pose.y_mm, 0.0, 2.0);
}

TEST(World, ShowsACliffToTheSensorsAboveIt) {
  const World world = world_of("cliff 0 -5000 5000 10000\n");
  Inputs inputs = seen_from(world, at(-151, 0, 0));
  EXPECT_FALSE(inputs.cliff_left.cliff);
  EXPECT_FALSE(inputs.any_cliff());
  inputs = seen_from(world, at(-149, 0, 0));
  EXPECT_TRUE(inputs.cliff_front_left.cliff);
  EXPECT_TRUE(inputs.cliff_front_right.cliff);
  EXPECT_FALSE(inputs.cliff_left.cliff);
  EXPECT_LT(inputs.cliff_front_left.signal, 100);
  EXPECT_GT(inputs.cliff_left.signal, 1000);
  EXPECT_FALSE(inputs.any_wheel_drop());
}

TEST(World, DropsAWheelOnceNoFloorIsNearIt) {
  const World world = world_of("cliff 0 -5000 5000 10000\n");
  EXPECT_FALSE(seen_from(world, at(-119, 0, 0)).any_wheel_drop());
  Inputs inputs = seen_from(world, at(-117, 0, 0));
  EXPECT_TRUE(inputs.wheel_drop_caster);
  EXPECT_FALSE(inputs.wheel_drop_left);
  EXPECT_FALSE(seen_from(world, at(11, 0, 0)).wheel_drop_left);
  inputs = seen_from(world, at(13, 0, 0));
  EXPECT_TRUE(inputs.wheel_drop_left);
  EXPECT_TRUE(inputs.wheel_drop_right);
}

TEST(World, DropsTheCasterAboutWhereTheSensorsSeeTheCornerOfAHole) {
  const World world = world_of("cliff 0 0 500 500\n");
  // Straight at the corner, along its diagonal.
  const auto from_corner = [&](double away_mm) {
    const double each = away_mm * std::sqrt(0.5);
    return seen_from(world, at(-each, -each, 45));
  };
  EXPECT_FALSE(from_corner(114).any_wheel_drop());
  EXPECT_TRUE(from_corner(112).wheel_drop_caster);
  EXPECT_FALSE(from_corner(111).any_cliff());
  const Inputs inputs = from_corner(109);
  EXPECT_TRUE(inputs.cliff_front_left.cliff);
  EXPECT_TRUE(inputs.cliff_front_right.cliff);
}

TEST(World, StopsASafeRobotAtACliff) {
  const World world = world_of("cliff 1000 -5000 5000 10000\n");
  Robot robot{ideal_wheels()};
  inhabit(robot.device, world);
  robot.send({128, 131, 145, 1, 244, 1, 244});
  robot.wait(5s);
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
  EXPECT_EQ(robot.device.last_safety_condition(), SafetyCondition::cliff);
  EXPECT_LT(robot.device.truth().pose.x_mm, 900.0);
}

TEST(World, ShowsAWallToTheSensorAtTheRight) {
  const World world = world_of("wall -5000 -200 5000 -200\n");
  EXPECT_TRUE(seen_from(world, at(0, 0, 0)).wall);
  const std::uint16_t near = seen_from(world, at(0, -25, 0)).wall_signal;
  const std::uint16_t far = seen_from(world, at(0, 0, 0)).wall_signal;
  EXPECT_GT(near, far);
  EXPECT_GT(far, 0);
  EXPECT_FALSE(seen_from(world, at(0, 0, 180)).wall) << "it is to the left";
  EXPECT_EQ(seen_from(world, at(0, 200, 0)).wall_signal, 0);
}

TEST(World, ShowsAVirtualWallInItsBeamAndNotBehindAWall) {
  const World world = world_of("virtual-wall 0 0 0\n");
  EXPECT_TRUE(seen_from(world, at(1000, 0, 0)).virtual_wall);
  EXPECT_TRUE(seen_from(world, at(1000, 100, 0)).virtual_wall);
  EXPECT_FALSE(seen_from(world, at(1000, 400, 0)).virtual_wall);
  EXPECT_FALSE(seen_from(world, at(-1000, 0, 0)).virtual_wall);
  EXPECT_FALSE(seen_from(world, at(3000, 0, 0)).virtual_wall);
  const World walled = world_of("virtual-wall 0 0 0\nwall 500 -500 500 500\n");
  EXPECT_FALSE(seen_from(walled, at(1000, 0, 0)).virtual_wall);
}

TEST(World, ShowsTheHomeBasesBuoysAndField) {
  const World world = world_of("home-base 0 0 90\n");
  EXPECT_EQ(seen_from(world, at(0, 1200, 0)).infrared, 252) << "both";
  EXPECT_EQ(seen_from(world, at(-500, 1200, 0)).infrared, 248) << "red is to its left";
  EXPECT_EQ(seen_from(world, at(500, 1200, 0)).infrared, 244);
  EXPECT_EQ(seen_from(world, at(0, 500, 0)).infrared, 254);
  EXPECT_EQ(seen_from(world, at(0, -300, 0)).infrared, 242);
  EXPECT_EQ(seen_from(world, at(0, 3000, 0)).infrared, 255);
  EXPECT_TRUE(seen_from(world, at(0, 500, 0)).virtual_wall) << "the force field trips it";
}

TEST(World, DocksTheRobotThatFacesTheBase) {
  const World world = world_of("home-base 0 0 90\n");
  EXPECT_TRUE(seen_from(world, at(0, 180, 270)).home_base);
  EXPECT_FALSE(seen_from(world, at(0, 180, 90)).home_base);
  EXPECT_FALSE(seen_from(world, at(0, 300, 270)).home_base);
}

TEST(World, LetsTheDockDemoDock) {
  const World world = world_of(
      "wall -1500 0 1500 0\nwall 1500 0 1500 3000\nwall 1500 3000 -1500 3000\n"
      "wall -1500 3000 -1500 0\nhome-base 0 20 90\nstart 300 1400 270\n");
  Robot robot;
  inhabit(robot.device, world);
  robot.send({128, 143});
  for (int i = 0; i < 600 && !robot.device.battery().charging(); ++i) robot.wait(100ms);
  EXPECT_TRUE(robot.device.battery().charging());
  EXPECT_EQ(robot.device.commanded().left_mm_s, 0.0);
}

TEST(World, KeepsACoveringRobotInTheRoomAndOffTheStairs) {
  const Result<World> world = World::load(CARGOBAY_SOURCE_DIR "/examples/worlds/room.world");
  ASSERT_TRUE(world);
  Robot robot;
  inhabit(robot.device, *world);
  robot.send({128, 135});
  for (int i = 0; i < 3000; ++i) {
    robot.wait(100ms);
    const WorldPose pose = robot.device.truth().pose;
    ASSERT_GT(pose.x_mm, 0.0);
    ASSERT_LT(pose.x_mm, 4000.0);
    ASSERT_GT(pose.y_mm, 0.0);
    ASSERT_LT(pose.y_mm, 3000.0);
  }
  EXPECT_TRUE(robot.device.demos().running());
}

TEST(World, LetsARobotDockInTheShippedRoom) {
  const Result<World> world = World::load(CARGOBAY_SOURCE_DIR "/examples/worlds/room.world");
  ASSERT_TRUE(world);
  Robot robot;
  inhabit(robot.device, *world);
  robot.send({128, 143});
  for (int i = 0; i < 6000 && !robot.device.battery().charging(); ++i) robot.wait(100ms);
  EXPECT_TRUE(robot.device.battery().charging());
}

TEST(World, KeepsASafeRobotOnTheShippedTable) {
  const Result<World> world = World::load(CARGOBAY_SOURCE_DIR "/examples/worlds/table.world");
  ASSERT_TRUE(world);
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 15) {
    Robot robot;
    inhabit(robot.device, *world);
    robot.device.place(at(800, 500, heading_deg));
    robot.send({128, 131, 137, 1, 44, 0x80, 0});
    robot.wait(8s);
    const WorldPose pose = robot.device.truth().pose;
    EXPECT_EQ(robot.device.mode(), oi::Mode::passive) << heading_deg;
    EXPECT_TRUE(robot.device.last_safety_condition()) << heading_deg;
    EXPECT_LT(std::abs(pose.x_mm - 800.0), 800.0) << heading_deg;
    EXPECT_LT(std::abs(pose.y_mm - 500.0), 500.0) << heading_deg;
  }
}

TEST(World, CannotKeepARobotInFullOnTheTable) {
  const Result<World> world = World::load(CARGOBAY_SOURCE_DIR "/examples/worlds/table.world");
  ASSERT_TRUE(world);
  Robot robot;
  inhabit(robot.device, *world);
  robot.send({128, 132, 137, 1, 44, 0x80, 0});
  robot.wait(8s);
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
  EXPECT_GT(robot.device.truth().pose.x_mm, 1600.0);
}

TEST(World, IsDrawnWithoutAPathToo) {
  const std::string drawing = draw(world_of("wall 0 0 1000 0\n"), {});
  EXPECT_EQ(drawing.substr(0, 5), "<svg ");
  EXPECT_EQ(drawing.substr(drawing.size() - 7), "</svg>\n");
  EXPECT_NE(drawing.find("class='wall'"), std::string::npos);
  EXPECT_EQ(drawing.find("class='path'"), std::string::npos);
}

TEST(World, IsDrawnWithThePathItsBumpsAndItsLeaps) {
  const std::array<Waypoint, 4> path{{{.pose = at(0, 0, 0)},
                                      {.pose = at(100, 0, 0), .bumped = true},
                                      {.pose = at(500, 500, 0), .placed = true},
                                      {.pose = at(500, 600, 90)}}};
  const std::string drawing = draw(World{}, path);
  EXPECT_NE(drawing.find("<path class='path' d='M0 0 100 0M500 -500 500 -600'/>"),
            std::string::npos)
      << drawing;
  EXPECT_NE(drawing.find("<circle class='bump' cx='100' cy='0'"), std::string::npos);
  EXPECT_NE(drawing.find("<circle class='robot' cx='500' cy='-600'"), std::string::npos);
}

// docs/virtual-create.md has this table.
TEST(World, WeakensTheWallSignalWithDistance) {
  struct Row {
    double away_mm;
    std::uint16_t signal;
    bool wall;
  };
  for (const Row& row : {Row{0.0, 4095, true}, Row{10.0, 3753, true}, Row{30.0, 3071, true},
                         Row{59.0, 2081, true}, Row{60.0, 2047, false}, Row{90.0, 1023, false},
                         Row{119.0, 34, false}, Row{120.0, 0, false}, Row{500.0, 0, false}}) {
    World world;
    const double x_mm = kRobotRadiusMm + row.away_mm;
    world.walls.push_back({.from = {x_mm, -500.0}, .to = {x_mm, 500.0}});
    const Inputs seen = seen_from(world, at(0, 0, 65.0));  // the sensor looks along x
    EXPECT_NEAR(seen.wall_signal, row.signal, 1) << row.away_mm;
    EXPECT_EQ(seen.wall, row.wall) << row.away_mm;
  }
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin) + begin.size();
  return text.substr(from, text.find(end, from) - from);
}

TEST(World, IsDrawnWithCoordinatesSizeAndLegend) {
  const World world = world_of("wall 0 0 4000 0\nwall 4000 0 4000 3000\npost 1000 1000 50\n");
  const std::string drawing = draw(world, {});
  for (const char* label : {">0<", ">0.5<", ">4<", ">3<", ">wall<", ">furniture<", ">robot<"})
    EXPECT_NE(drawing.find(label), std::string::npos) << label;
  EXPECT_NE(drawing.find("m; grid every 0.5 m"), std::string::npos);
  EXPECT_EQ(drawing.find(">bump<"), std::string::npos) << "there was none";
  EXPECT_EQ(drawing.find(">no floor<"), std::string::npos);
}

// A hundred metres are no wider on the page than ten, and have a grid that can be counted.
TEST(World, IsDrawnSmallerIfItIsLarge) {
  const std::string drawing = draw(world_of("wall 0 0 100000 0\nwall 0 0 0 40000\n"), {});
  EXPECT_LE(std::stod(between(drawing, "width='", "'")), 1300.0);
  EXPECT_LE(std::stod(between(drawing, "height='", "'")), 1300.0);
  EXPECT_NE(drawing.find("grid every 10 m"), std::string::npos);
}

}  // namespace
}  // namespace cargobay::hal::sim
