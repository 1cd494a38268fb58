// OI p. 8: the demos that move, in worlds.
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/demos/demos.hpp"
#include "hal/sim/world/world.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

constexpr double kTapedDeg = 30.0;  // what tape leaves open of the receiver
constexpr const char* kRoom =
    "wall 0 0 3000 0\nwall 3000 0 3000 3000\nwall 3000 3000 0 3000\nwall 0 3000 0 0\n";

World world_with(const std::string& more) {
  Result<World> world = World::parse(kRoom + more);
  EXPECT_TRUE(world) << (world ? "" : world.failure().message);
  return world ? *world : World{};
}

WorldPose at(double x_mm, double y_mm, double heading_deg) {
  return {x_mm, y_mm, heading_deg * std::numbers::pi / 180.0};
}

Parameters with_receiver(double opening_deg) {
  Parameters parameters;
  parameters.receiver_opening_deg = opening_deg;
  return parameters;
}

// A demo in a world, from a place of its own.
struct Living : Robot {
  Living(const World& world, const WorldPose& pose, std::uint8_t demo,
         double opening_deg = kAllAroundDeg)
      : Robot{with_receiver(opening_deg)} {
    inhabit(device, world);
    device.place(pose);
    send({128, 136, demo});
  }
  WorldPose pose() const { return device.truth().pose; }
  double away_mm(double x_mm, double y_mm) const {
    return std::hypot(pose().x_mm - x_mm, pose().y_mm - y_mm);
  }
  // Seconds until `done`, at most so many.
  template <typename Done>
  double until(Done&& done, double most_s) {
    const double began_s = rt::seconds(device.now());
    while (!done() && rt::seconds(device.now()) - began_s < most_s) wait(100ms);
    return rt::seconds(device.now()) - began_s;
  }
};

// What finds the base: after minutes of turns the robot still knows which way it faces.
TEST(DemoWorlds, CoverKeepsTheHeadingThatItReckonsWith) {
  const World world = world_with("post 1500 1500 60\n");
  Living robot{world, at(1000, 1200, 30), 0};
  const double from_deg = robot.pose().heading_rad * 180.0 / std::numbers::pi;
  double turned_deg = 0.0;
  for (int i = 0; i < 1200; ++i) {
    robot.wait(90ms);
    turned_deg += word(robot.ask({142, 20}), 0);
  }
  const double truth_deg = robot.pose().heading_rad * 180.0 / std::numbers::pi - from_deg;
  EXPECT_NEAR(std::remainder(turned_deg - truth_deg, 360.0), 0.0, 3.0);
}

TEST(DemoWorlds, CoverBouncesFollowsWallsAndSpirals) {
  const World world = world_with("");
  Living robot{world, at(1000, 1200, 30), 0};
  bool bounces = false;
  double along_s = 0.0;
  double spirals_s = 0.0;
  double longest_along_s = 0.0;
  double longest_spiral_s = 0.0;
  for (int i = 0; i < 6000; ++i) {
    robot.wait(100ms);
    const WheelSpeeds speeds = robot.device.commanded();
    bounces = bounces || (speeds.left_mm_s < 0.0) != (speeds.right_mm_s < 0.0);
    const bool sees_wall = robot.device.seen().wall_signal > 0;
    along_s = sees_wall ? along_s + 0.1 : 0.0;
    const bool turns_left = speeds.left_mm_s > 0.0 && speeds.right_mm_s > speeds.left_mm_s + 20.0;
    spirals_s = turns_left && !sees_wall ? spirals_s + 0.1 : 0.0;
    longest_along_s = std::max(longest_along_s, along_s);
    longest_spiral_s = std::max(longest_spiral_s, spirals_s);
  }
  EXPECT_TRUE(bounces);
  EXPECT_GT(longest_along_s, 5.0);
  EXPECT_GT(longest_spiral_s, 5.0);
}

// The base in the middle of a wall 3 m wide, from all the places that see a beam.
TEST(DemoWorlds, CoverAndDockDocksFromEveryPlaceThatSeesABeam) {
  const World world = world_with("home-base 1500 20 90\n");
  int starts = 0;
  for (int x = 300; x <= 2700; x += 300) {
    for (int y = 220; y <= 1720; y += 250) {
      Inputs seen;
      world.sense(at(x, y, 0), seen);
      if (!seen.beams().any()) continue;
      Living robot{world, at(x, y, 77.0 * ++starts), 1};
      const auto ends = [&] { return !robot.device.demos().running(); };
      EXPECT_LT(robot.until(ends, 180.0), 180.0) << x << ' ' << y;
      EXPECT_TRUE(robot.device.battery().charging()) << x << ' ' << y;
    }
  }
  EXPECT_GT(starts, 20);
}

TEST(DemoWorlds, CoverAndDockDocksFromStraightInFront) {
  const World world = world_with("home-base 1500 20 90\n");
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 45) {
    Living robot{world, at(1500, 1220, heading_deg), 1};
    const auto charging = [&] { return robot.device.battery().charging(); };
    EXPECT_LT(robot.until(charging, 180.0), 180.0) << heading_deg;
  }
}

TEST(DemoWorlds, FigureEightClosesWhereItBegan) {
  const World world = world_with("");
  Living robot{world, at(1500, 1500, 0), 4};
  double began_deg = robot.pose().heading_rad;
  for (int eight = 0; eight < 3; ++eight) {
    // A circle to the left and one to the right.
    const auto turned = [&](double by_rad) {
      return [&robot, began_deg, by_rad] {
        return by_rad > 0.0 ? robot.pose().heading_rad - began_deg > by_rad
                            : robot.pose().heading_rad - began_deg < 0.1;
      };
    };
    EXPECT_LT(robot.until(turned(6.1), 30.0), 30.0);
    EXPECT_LT(robot.until(turned(0.0), 30.0), 30.0);
    EXPECT_LT(robot.away_mm(1500, 1500), 120.0) << eight;
    began_deg = robot.pose().heading_rad;
  }
  EXPECT_TRUE(robot.device.demos().running());
}

TEST(DemoWorlds, WimpDrivesForwardWhenPushedFromBehind) {
  const World world = world_with("");
  Living robot{world, at(1000, 1500, 0), 5};
  robot.wait(5s);
  EXPECT_LT(robot.away_mm(1000, 1500), 1.0) << "it waits for a push";
  for (int push = 0; push < 2; ++push) {
    const double before_mm = robot.pose().x_mm;
    robot.device.turn_wheels({60.0, 60.0});
    robot.wait(300ms);
    robot.device.turn_wheels({0.0, 0.0});
    robot.wait(8s);
    EXPECT_NEAR(robot.pose().x_mm - before_mm, 500.0, 80.0) << push;
    EXPECT_EQ(robot.device.commanded(), WheelSpeeds{}) << "and comes to rest";
  }
}

TEST(DemoWorlds, WimpDrivesAwayFromWhatItMeets) {
  const World world = world_with("");
  Living robot{world, at(2600, 1500, 0), 5};
  robot.wait(1s);
  robot.device.turn_wheels({60.0, 60.0});
  robot.wait(300ms);
  robot.device.turn_wheels({0.0, 0.0});
  robot.wait(15s);
  EXPECT_LT(robot.pose().x_mm, 2780.0) << "it was at the wall, and left it";
  EXPECT_GT(std::abs(robot.pose().heading_rad), 0.5);
  EXPECT_EQ(robot.device.commanded(), WheelSpeeds{});
}

// Tape over the back and sides of the receiver.
TEST(DemoWorlds, ATapedReceiverSeesOnlyWhatIsAhead) {
  const World world = world_with("virtual-wall 1500 45 90\nhome-base 40 1500 0\n");
  const auto sees = [&](double heading_deg, double opening_deg) {
    Inputs seen;
    world.sense(at(1500, 1000, heading_deg), seen, opening_deg);
    return seen.virtual_wall;
  };
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 10) {
    const bool ahead = heading_deg >= 260 && heading_deg <= 280;
    EXPECT_EQ(sees(heading_deg, kTapedDeg), ahead) << heading_deg;
    EXPECT_TRUE(sees(heading_deg, kAllAroundDeg)) << heading_deg;
  }
  const auto byte_seen = [&](double heading_deg) {
    Inputs seen;
    world.sense(at(1000, 1500, heading_deg), seen, kTapedDeg);
    return seen.infrared;
  };
  EXPECT_EQ(byte_seen(180), 252);
  EXPECT_EQ(byte_seen(90), kNoInfrared);
}

TEST(DemoWorlds, HomeDrivesToTheVirtualWallAndStops) {
  const World world = world_with("virtual-wall 1500 45 100\n");
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 30) {
    Living robot{world, at(1300, 1500, heading_deg), 6, kTapedDeg};
    const auto over = [&] { return !robot.device.demos().running(); };
    EXPECT_LT(robot.until(over, 60.0), 60.0) << heading_deg;
    EXPECT_LT(robot.away_mm(1500, 45), 215.0) << heading_deg << ": it touches the wall";
    EXPECT_EQ(robot.device.commanded(), WheelSpeeds{});
  }
}

// Where it is in and out of the light all the way.
TEST(DemoWorlds, HomeDrivesAlongTheEdgeOfABeam) {
  const World world = world_with("virtual-wall 1500 45 90\n");
  for (const double x_mm : {1250.0, 1750.0}) {
    Living robot{world, at(x_mm, 1545, 0), 6, kTapedDeg};
    const auto over = [&] { return !robot.device.demos().running(); };
    EXPECT_LT(robot.until(over, 60.0), 60.0) << x_mm;
    EXPECT_LT(robot.away_mm(1500, 45), 215.0) << x_mm;
  }
}

TEST(DemoWorlds, HomeStopsAtAnotherObstacle) {
  const World world = world_with("virtual-wall 1500 45 90\npost 1500 700 30\n");
  Living robot{world, at(1400, 1500, 0), 6, kTapedDeg};
  // The post hides the wall from most places; from here the light passes beside it.
  const auto over = [&] { return !robot.device.demos().running(); };
  EXPECT_LT(robot.until(over, 60.0), 60.0);
  EXPECT_LT(robot.away_mm(1500, 700), 200.0);
}

TEST(DemoWorlds, TagGoesFromOneVirtualWallToTheNext) {
  const World world = world_with("virtual-wall 1500 500 90\nvirtual-wall 1500 2300 270\n");
  Living robot{world, at(1500, 1400, 45), 7, kTapedDeg};
  const auto touches = [&](double y_mm) {
    return [&robot, y_mm] { return robot.away_mm(1500, y_mm) < 215.0; };
  };
  EXPECT_LT(robot.until([&] { return touches(500)() || touches(2300)(); }, 60.0), 60.0);
  double next_mm = touches(500)() ? 2300 : 500;
  for (int i = 0; i < 4; ++i) {
    EXPECT_LT(robot.until(touches(next_mm), 60.0), 60.0) << i;
    next_mm = next_mm == 500 ? 2300 : 500;
  }
  EXPECT_TRUE(robot.device.demos().running());
}

// From behind one of them, which is in the way to the other.
TEST(DemoWorlds, TagGoesAroundAVirtualWallToTheNextOneBeyond) {
  const World world = world_with("virtual-wall 1500 45 90\nvirtual-wall 1500 1200 270\n");
  for (const double x_mm : {1400.0, 1500.0, 1600.0}) {
    Living robot{world, at(x_mm, 1900, 0), 7, kTapedDeg};
    const auto touches = [&](double y_mm) {
      return [&robot, y_mm] { return robot.away_mm(1500, y_mm) < 215.0; };
    };
    EXPECT_LT(robot.until(touches(1200), 60.0), 60.0) << x_mm;
    EXPECT_LT(robot.until(touches(45), 120.0), 120.0) << x_mm;
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
