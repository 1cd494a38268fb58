// A picture of a world and of the way a robot took in it, as SVG.
#pragma once

#include <span>
#include <string>

#include "hal/sim/wheels.hpp"
#include "hal/sim/world.hpp"

namespace cargobay::hal::sim {

// The whole of both, a millimetre a unit, x to the right and y up; the robot stands where the path
// ends.
std::string draw(const World& world, std::span<const Pose> path);

}  // namespace cargobay::hal::sim
