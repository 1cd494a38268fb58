// The findings of hal/doctor/doctor.hpp, for the commands that report them.
#pragma once

#include <string>
#include <vector>

#include "hal/doctor/doctor.hpp"
#include "rt/realtime.hpp"

namespace cargobay::cli {

// hal::examine() with the rights that the kernel grants when asked. Starts a thread and waits for
// it.
std::vector<hal::Finding> examine(const std::string& port, const rt::RealtimeRequest& rights);

// A JSON array of objects.
std::string json(const std::vector<hal::Finding>& findings);

}  // namespace cargobay::cli
