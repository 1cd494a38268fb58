// How a port is taken, and the message if it cannot be. Separate from the rest of PortLock, which
// the guard uses too: the guard takes no port and needs none of this.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>

#include "hal/port/port_lock.hpp"
#include "hal/port/port_users.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {
namespace {

std::string who_uses(const std::string& path) {
  const PortUsers users = find_port_users(path);
  if (users.found.empty()) return "another process; see which one with: sudo fuser -v " + path;
  return "another process, " + describe(users.found) + ": " + remedy(users.found.front());
}

}  // namespace

Failure cannot_open(const std::string& path, std::error_code error) {
  const std::string what = "cannot open " + path + ": ";
  switch (error.value()) {
    case ENOTTY:
    case EISDIR:
      return {what +
                  "not a terminal; name a serial port such as /dev/ttyUSB0, or what `cargobay sim` "
                  "prints",
              error};
    case ENOENT:
    case ENOTDIR:
    case ENXIO:
    case ENODEV:
      return {what + "no such port; plug the cable in, or list the ports with: cargobay ports",
              error};
    case EACCES:
    case EPERM:
      return {what +
                  "permission denied; join the group that owns it (sudo adduser $USER dialout) and "
                  "log in again",
              error};
    case EBUSY: return {what + "in use by " + who_uses(path), error};
    default: return {what + error.message(), error};
  }
}

// A port that only guards have is free as soon as they have said farewell. A port that no process
// has was released meanwhile, unless its user cannot be seen: in another container, for example.
Result<std::unique_ptr<PortLock>> PortLock::take(const std::string& path) {
  constexpr timespec kPause{.tv_sec = 0, .tv_nsec = 50'000'000};
  constexpr int kMostUnseen = 4;
  const rt::TimePoint limit = rt::Clock::now() + std::chrono::seconds{6};
  for (int unseen = 0;;) {
    auto lock = take_now(path);
    const bool busy = !lock && lock.failure().code == std::errc::device_or_resource_busy;
    if (!busy || rt::Clock::now() >= limit) return lock;
    const PortUsers users = find_port_users(path);
    if (users.found.empty() && ++unseen > kMostUnseen) return lock;
    if (!std::ranges::all_of(users.found, is_guard)) return lock;
    nanosleep(&kPause, nullptr);
  }
}

Result<std::unique_ptr<PortLock>> PortLock::take_now(const std::string& path) {
  const StandardNumbersTaken taken;
  const int descriptor = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return cannot_open(path, {errno, std::generic_category()});
  std::unique_ptr<PortLock> lock{new PortLock{PortDescriptor::adopt(descriptor)}};
  if (isatty(lock->descriptor()) == 0) return cannot_open(path, {ENOTTY, std::generic_category()});
  if (const std::error_code error = lock->lock()) return cannot_open(path, error);
  return lock;
}

}  // namespace cargobay::hal
