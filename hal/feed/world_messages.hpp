// The messages of a feed about a virtual Create and its world.
#pragma once

#include "hal/json_object.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/world/world.hpp"

namespace cargobay::hal {

// All of them allocate.
// `unix_time_s`: when the virtual Create's clock showed the truth's time.
void put_truth(JsonObject& message, const sim::NewestTruth& truth, double unix_time_s);
void put_world(JsonObject& message, const sim::World& world);
// What a person may do to a virtual Create: the lines of its control socket, and its faults.
void put_controls(JsonObject& message);

}  // namespace cargobay::hal
