// What makes a driver hand bytes over at once. The timer of an FTDI adapter bunches frames for up
// to 16 ms, longer than the robot's period.
#pragma once

#include <optional>
#include <string>

namespace cargobay::hal {

// Sets ASYNC_LOW_LATENCY where the driver has it: 1 ms for an FTDI, nothing for a PL011. It stays
// set.
void ask_for_low_latency(int descriptor);

// The timer of the port's adapter, in its folder of sysfs, set to 1 ms where that is allowed.
// Returns what it is now, in ms; nothing where the port has no such timer.
std::optional<int> shorten_latency_timer(const std::string& sysfs_folder);

}  // namespace cargobay::hal
