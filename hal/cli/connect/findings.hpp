// What hal/doctor/doctor.hpp found, for the commands that tell of it.
#pragma once

#include <string>
#include <vector>

#include "hal/doctor/doctor.hpp"
#include "rt/realtime.hpp"

namespace cargobay::cli {

// hal::examine() with the rights that the kernel gives when asked for them. Starts a thread and
// waits for it.
std::vector<hal::Finding> examine(const std::string& port, const rt::RealtimeRequest& rights);

// A JSON array, an object each.
std::string json(const std::vector<hal::Finding>& findings);

}  // namespace cargobay::cli
