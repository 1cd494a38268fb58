// A world by its text, for tests.
#pragma once

#include <string_view>

#include <gtest/gtest.h>

#include "hal/sim/world/world.hpp"

namespace cargobay::hal::sim::test {

inline World world_of(std::string_view text) {
  Result<World> world = World::parse(text);
  EXPECT_TRUE(world) << (world ? "" : world.failure().message);
  return world ? *world : World{};
}

}  // namespace cargobay::hal::sim::test
