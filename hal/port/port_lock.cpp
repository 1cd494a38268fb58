#include "hal/port/port_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "hal/port/tty_speed.hpp"

namespace cargobay::hal {
namespace {

std::error_code last_error() { return {errno, std::generic_category()}; }

std::error_code busy() { return std::make_error_code(std::errc::device_or_resource_busy); }

}  // namespace

std::error_code PortLock::lock() {
  const int port = descriptor();
  if (flock(port, LOCK_EX | LOCK_NB) != 0) return busy();
  if (tcgetattr(port, &found_) != 0) return last_error();
  found_speed_ = tty_speed(port);
  ours_ = true;
  ioctl(port, TIOCEXCL);
  return {};
}

void PortLock::let_go() const {
  ioctl(descriptor(), TIOCNXCL);
  flock(descriptor(), LOCK_UN);
}

std::error_code PortLock::hand_over(int descriptor) {
  PortDescriptor other = PortDescriptor::duplicate(descriptor);
  if (other.number() < 0) return last_error();
  if (flock(other.number(), LOCK_EX | LOCK_NB) != 0) return busy();
  ioctl(other.number(), TIOCEXCL);
  descriptor_ = std::move(other);
  return {};
}

std::error_code PortLock::keep_modem_lines() {
  found_.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
  termios settings{};
  if (tcgetattr(descriptor(), &settings) != 0) return last_error();
  if ((settings.c_cflag & HUPCL) == 0) return {};
  const std::optional<std::uint32_t> speed = tty_speed(descriptor());
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
  if (tcsetattr(descriptor(), TCSANOW, &settings) != 0) return last_error();
  // As in the destructor.
  return speed ? set_tty_speed(descriptor(), *speed) : std::error_code{};
}

// A user's own terminal, named by mistake, can then be typed on again.
PortLock::~PortLock() {
  if (!ours_ || !still_open()) return;
  tcsetattr(descriptor(), TCSANOW, &found_);
  // termios cannot hold a rate that has no constant.
  if (found_speed_.has_value() && tty_speed(descriptor()) != found_speed_) {
    (void)set_tty_speed(descriptor(), *found_speed_);  // there is nothing left to report it to
  }
  let_go();
}

}  // namespace cargobay::hal
