// Random rooms: outlines, furniture, stairs, a Home Base and virtual walls, the same for a seed on
// every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/sim/world/world.hpp"

namespace cargobay::campaign {

struct RandomRoom {
  hal::sim::World world{};
  std::vector<hal::sim::Point> outline{};  // the corners, counter-clockwise

  bool contains(hal::sim::Point at) const;
};

enum class Furnished : std::uint8_t {
  for_cover,  // a Home Base, and sometimes virtual walls and stairs
  for_home,   // a virtual wall; no base, no stairs
  for_tag,    // two virtual walls that face each other
};

// The robot starts at any place where it touches nothing and has floor below it; in the rooms for
// Home and Tag, where it could see a virtual wall if it turned that way.
RandomRoom random_room(std::uint64_t seed, Furnished furnished);

}  // namespace cargobay::campaign
