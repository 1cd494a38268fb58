#include "hal/port_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

#include "hal/port_users.hpp"
#include "hal/tty_speed.hpp"

namespace cargobay::hal {
namespace {

std::string who_uses(const std::string& path) {
  const PortUsers users = find_port_users(path);
  if (users.found.empty()) return "another process; see who it is with: sudo fuser -v " + path;
  return "another process, " + describe(users.found) + ": " + remedy(users.found.front());
}

}  // namespace

Failure cannot_open(const std::string& path, int error) {
  const std::error_code code{error, std::generic_category()};
  const std::string what = "cannot open " + path + ": ";
  switch (error) {
    case ENOTTY:
    case EISDIR:
      return {what +
                  "not a terminal; name a serial port such as /dev/ttyUSB0, or what `cargobay sim` "
                  "prints",
              code};
    case ENOENT:
    case ENOTDIR:
    case ENXIO:
    case ENODEV:
      return {what + "no such port; plug the cable in, or list what there is with: cargobay ports",
              code};
    case EACCES:
    case EPERM:
      return {what +
                  "permission denied; join the group that owns it (sudo adduser $USER dialout) and "
                  "log in anew",
              code};
    case EBUSY: return {what + "in use by " + who_uses(path), code};
    default: return {what + code.message(), code};
  }
}

Result<std::unique_ptr<PortLock>> PortLock::take(const std::string& path) {
  const StandardNumbersTaken taken;
  const int descriptor = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return cannot_open(path, errno);
  std::unique_ptr<PortLock> lock{new PortLock{PortDescriptor::adopt(descriptor)}};
  if (isatty(lock->descriptor()) == 0) return cannot_open(path, ENOTTY);
  if (const int error = lock->lock(); error != 0) return cannot_open(path, error);
  return lock;
}

int PortLock::lock() {
  const int port = descriptor();
  if (flock(port, LOCK_EX | LOCK_NB) != 0) return EBUSY;
  if (tcgetattr(port, &found_) != 0) return errno;
  found_speed_ = tty_speed(port);
  ours_ = true;
  ioctl(port, TIOCEXCL);
  return 0;
}

void PortLock::let_go() const {
  ioctl(descriptor(), TIOCNXCL);
  flock(descriptor(), LOCK_UN);
}

int PortLock::hand_over(int descriptor) {
  PortDescriptor other = PortDescriptor::duplicate(descriptor);
  if (other.number() < 0) return errno;
  if (flock(other.number(), LOCK_EX | LOCK_NB) != 0) return EBUSY;
  ioctl(other.number(), TIOCEXCL);
  descriptor_ = std::move(other);
  return 0;
}

// Somebody's own terminal, named by mistake, is one that can be typed on again.
PortLock::~PortLock() {
  if (!ours_ || !still_open()) return;
  tcsetattr(descriptor(), TCSANOW, &found_);
  // A rate without a constant of its own is not in termios.
  if (found_speed_.has_value() && tty_speed(descriptor()) != found_speed_) {
    (void)set_tty_speed(descriptor(), *found_speed_);  // nobody is left to be told
  }
  let_go();
}

}  // namespace cargobay::hal
