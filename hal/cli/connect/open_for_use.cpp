#include "hal/cli/connect/open_for_use.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include "hal/bring_up/robot_pins.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/port/open_port.hpp"

namespace cargobay::cli {
namespace {

bool is_open_as(const std::string& port, int descriptor) {
  struct stat named{};
  struct stat open{};
  return stat(port.c_str(), &named) == 0 && fstat(descriptor, &open) == 0 &&
         S_ISCHR(named.st_mode) && S_ISCHR(open.st_mode) && named.st_rdev == open.st_rdev;
}

}  // namespace

hal::Result<std::unique_ptr<hal::ByteStream>> open_for_use(const std::string& path,
                                                           std::uint32_t baud) {
  if (is_open_as(path, STDOUT_FILENO) || is_open_as(path, STDERR_FILENO)) {
    return hal::Failure{path +
                        " is also where this command prints, and the robot would take its output "
                        "for commands; redirect the output elsewhere"};
  }
  auto port = hal::open_port(path, baud);
  if (!port) return port.failure();
  if (!port->remark.empty()) print_remark(port->remark);
  return std::move(port->stream);
}

hal::Result<std::unique_ptr<hal::ByteStream>> open_plain(const hal::ChosenRobot& chosen,
                                                         std::uint32_t baud) {
  auto port = open_for_use(chosen.port, baud);
  // Of a port that has neither line, nothing hangs on one.
  if (port) (void)hal::BoundPins{chosen.pins(), **port}.release();
  return port;
}

}  // namespace cargobay::cli
