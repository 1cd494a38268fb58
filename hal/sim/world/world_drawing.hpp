// A picture of a world and of a robot's path in it, as SVG.
#pragma once

#include <span>
#include <string>

#include "hal/sim/world/path_recorder.hpp"
#include "hal/sim/world/world.hpp"

namespace cargobay::hal::sim {

// All of both, one unit per millimetre, x to the right and y up, over a grid with coordinates in
// metres. A ring marks the beginning of the path, a dot each bump; the robot is drawn at the end of
// the path, its bumper ahead. Size and legend are below. At most 1300 pixels without the legend, on
// a background of its own.
std::string draw(const World& world, std::span<const Waypoint> path);

}  // namespace cargobay::hal::sim
