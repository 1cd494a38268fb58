// The conditions under which a benchmark ran: without them its figures mean nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace cargobay::hal::jitter {

struct Conditions {
  std::string kernel{};      // uname -r
  std::string preemption{};  // "PREEMPT_RT", "PREEMPT_DYNAMIC", ...
  std::string board{};       // from the device tree, or the product name; empty if neither exists
  std::string processor{};
  int processors = 0;
  std::string governor{};                    // empty if there is none, as in a virtual machine
  std::optional<double> temperature_c{};     // of the first thermal zone
  std::optional<std::uint32_t> throttled{};  // Raspberry Pi firmware's get_throttled; 0: never
  double load = 0.0;                         // runnable tasks, one-minute average
};

// What the kernel counted for this process and machine; the difference of two readings is a run's.
struct Usage {
  double steal_s = 0.0;  // of all processors: time that a hypervisor gave to other machines
  double busy_s = 0.0;   // of this process, user and system
  std::uint64_t voluntary_switches = 0;
  std::uint64_t involuntary_switches = 0;
  std::uint64_t minor_faults = 0;
  std::uint64_t major_faults = 0;
};

// `root` is put in front of /proc and /sys, for tests. Reads files: blocks, allocates.
Conditions look_at_conditions(const std::string& root = "");
Usage look_at_usage();
Usage operator-(const Usage& after, const Usage& before);

}  // namespace cargobay::hal::jitter
