// A picture of a world and of the way a robot took in it, as SVG.
#pragma once

#include <span>
#include <string>

#include "hal/sim/world/path_recorder.hpp"
#include "hal/sim/world/world.hpp"

namespace cargobay::hal::sim {

// The whole of both, a millimetre a unit, x to the right and y up, over a grid of half metres. A
// ring marks where the path begins, a dot each bump; the robot stands where the path ends, its
// bumper ahead.
std::string draw(const World& world, std::span<const Waypoint> path);

}  // namespace cargobay::hal::sim
