// How to make a driver hand bytes over at once. The latency timer of an FTDI adapter holds frames
// back and bunches them for up to 16 ms, longer than the robot's period.
#pragma once

#include <optional>
#include <string>

namespace cargobay::hal {

// Sets ASYNC_LOW_LATENCY if the driver has it: 1 ms for an FTDI, no effect on a PL011. It stays
// set.
void ask_for_low_latency(int descriptor);

// Sets the latency timer of the port's adapter, in its sysfs folder, to 1 ms if that is allowed.
// Returns what it is now, in ms; nothing if the port has no such timer.
std::optional<int> shorten_latency_timer(const std::string& sysfs_folder);

}  // namespace cargobay::hal
