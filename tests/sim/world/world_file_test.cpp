#include <cstddef>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "hal/sim/world/world.hpp"
#include "tests/sim/world/world_of.hpp"

namespace cargobay::hal::sim {
namespace {

using test::world_of;

TEST(World, ReadsEachKindOfThing) {
  const World world = world_of(
      "# all of them\n"
      "wall 0 0 1000 0\n"
      "box 1 2 3 4   # with a comment\n"
      "\n"
      "  post -1.5 2e3 40\r\n"
      "cliff 0 0 10 10\n"
      "virtual-wall 1 2 90\n"
      "home-base 3 4 180\n"
      "start 5 6 90");
  EXPECT_EQ(world.walls.size(), 1U);
  EXPECT_EQ(world.boxes.at(0).height_mm, 4.0);
  EXPECT_EQ(world.posts.at(0).centre.y_mm, 2000.0);
  EXPECT_EQ(world.cliffs.size(), 1U);
  EXPECT_EQ(world.virtual_walls.at(0).heading_deg, 90.0);
  EXPECT_EQ(world.home_base->heading_deg, 180.0);
  EXPECT_NEAR(world.start().heading_rad, std::numbers::pi / 2.0, 1e-12);
}

TEST(World, NamesTheLineItCannotRead) {
  for (const char* bad : {"wall 0 0 1000", "wall 0 0 1000 0 0", "post a 0 1", "hole 1 2 3 4",
                          "start 1 2 inf", "box 1 2 3 4x"}) {
    const Result<World> world = World::parse(std::string{"# first\n"} + bad + "\nwall 0 0 1 1\n");
    ASSERT_FALSE(world) << bad;
    EXPECT_EQ(world.failure().message.substr(0, 8), "line 2: ") << world.failure().message;
  }
}

TEST(World, HasAStartForEachRobot) {
  const World world = world_of("start 1 2 0\nstart 100 200 90\n");
  EXPECT_EQ(world.start(0).y_mm, 2.0);
  EXPECT_EQ(world.start(1).x_mm, 100.0);
  // Half a metre to the left of the one before, which faces up.
  EXPECT_NEAR(world.start(3).x_mm, -900.0, 1e-9);
  EXPECT_NEAR(world.start(3).y_mm, 200.0, 1e-9);
  EXPECT_EQ(world_of("").start(0).y_mm, 0.0);
  EXPECT_EQ(world_of("").start(1).y_mm, 500.0);
}

TEST(World, SaysWhichFileItCannotRead) {
  for (const char* path : {"/nowhere/at.all", "/"}) {
    const Result<World> world = World::load(path);
    ASSERT_FALSE(world) << path;
    EXPECT_NE(world.failure().message.find(path), std::string::npos);
  }
}

TEST(World, LoadsTheWorldsThatAreShipped) {
  std::size_t worlds = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator{CARGOBAY_SOURCE_DIR "/examples/worlds"}) {
    const Result<World> world = World::load(entry.path());
    ASSERT_TRUE(world) << world.failure().message;
    EXPECT_FALSE(world->collide(world->start())) << "the robot begins free";
    ++worlds;
  }
  EXPECT_GE(worlds, 2U);
}

}  // namespace
}  // namespace cargobay::hal::sim
