#include "hal/port/low_latency.hpp"

#include <linux/serial.h>
#include <sys/ioctl.h>

#include <fstream>

namespace cargobay::hal {
namespace {

std::optional<int> read_number(const std::string& path) {
  std::ifstream file{path};
  int number = 0;
  if (!(file >> number)) return std::nullopt;
  return number;
}

}  // namespace

void ask_for_low_latency(int descriptor) {
  serial_struct settings{};
  if (ioctl(descriptor, TIOCGSERIAL, &settings) != 0) return;  // the driver has no such settings
  settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
  ioctl(descriptor, TIOCSSERIAL, &settings);
}

std::optional<int> shorten_latency_timer(const std::string& sysfs_folder) {
  const std::string path = sysfs_folder + "/latency_timer";
  const std::optional<int> found = read_number(path);
  if (!found || *found <= 1) return found;
  std::ofstream{path} << 1 << std::flush;
  return read_number(path);
}

}  // namespace cargobay::hal
