#include "hal/doctor/conditions.hpp"

#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace cargobay::hal::jitter {
namespace {

// The first line; empty if there is none. Strings in a device tree end with a NUL.
std::string line_of(const std::string& path) {
  std::ifstream file{path};
  std::string line;
  std::getline(file, line);
  while (!line.empty() && (line.back() == '\0' || line.back() == ' ')) line.pop_back();
  return line;
}

std::string processor_of(const std::string& path) {
  std::ifstream file{path};
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "";
}

// From `uname -v`; a mainline kernel with PREEMPT_RT reports it there since 6.12, older ones in a
// file.
std::string preemption_of(const std::string& version, const std::string& realtime) {
  if (realtime == "1") return "PREEMPT_RT";
  for (const char* model : {"PREEMPT_RT", "PREEMPT_DYNAMIC", "PREEMPT"}) {
    if (version.find(model) != std::string::npos) return model;
  }
  return "none";
}

double as_seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

// The eighth figure after "cpu" in /proc/stat, in clock ticks.
double steal_s() {
  std::istringstream words{line_of("/proc/stat")};
  std::string word;
  double ticks = 0.0;
  words >> word;
  for (int i = 0; i < 8 && words >> ticks; ++i) {
  }
  return words ? ticks / static_cast<double>(sysconf(_SC_CLK_TCK)) : 0.0;
}

}  // namespace

Conditions look_at_conditions(const std::string& root) {
  Conditions now;
  utsname system{};
  if (uname(&system) == 0) {
    now.kernel = static_cast<const char*>(system.release);
    now.preemption = preemption_of(static_cast<const char*>(system.version),
                                   line_of(root + "/sys/kernel/realtime"));
  }
  now.board = line_of(root + "/proc/device-tree/model");
  if (now.board.empty()) now.board = line_of(root + "/sys/class/dmi/id/product_name");
  now.processor = processor_of(root + "/proc/cpuinfo");
  now.processors = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  now.governor = line_of(root + "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  const std::string zone = line_of(root + "/sys/class/thermal/thermal_zone0/temp");
  if (!zone.empty()) now.temperature_c = std::strtod(zone.c_str(), nullptr) / 1000.0;
  const std::string throttled =
      line_of(root + "/sys/devices/platform/soc/soc:firmware/get_throttled");
  if (!throttled.empty())
    now.throttled = static_cast<std::uint32_t>(std::strtoul(throttled.c_str(), nullptr, 16));
  now.load = std::strtod(line_of(root + "/proc/loadavg").c_str(), nullptr);
  return now;
}

Usage look_at_usage() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return {.steal_s = steal_s(),
          .busy_s = as_seconds(used.ru_utime) + as_seconds(used.ru_stime),
          .voluntary_switches = static_cast<std::uint64_t>(used.ru_nvcsw),
          .involuntary_switches = static_cast<std::uint64_t>(used.ru_nivcsw),
          .minor_faults = static_cast<std::uint64_t>(used.ru_minflt),
          .major_faults = static_cast<std::uint64_t>(used.ru_majflt)};
}

Usage operator-(const Usage& after, const Usage& before) {
  return {.steal_s = after.steal_s - before.steal_s,
          .busy_s = after.busy_s - before.busy_s,
          .voluntary_switches = after.voluntary_switches - before.voluntary_switches,
          .involuntary_switches = after.involuntary_switches - before.involuntary_switches,
          .minor_faults = after.minor_faults - before.minor_faults,
          .major_faults = after.major_faults - before.major_faults};
}

}  // namespace cargobay::hal::jitter
