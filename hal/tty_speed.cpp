#include "hal/tty_speed.hpp"

#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cerrno>

// <asm/termbits.h> and <termios.h> both define struct termios: nothing here may include the other.

namespace cargobay::hal {

std::error_code set_tty_speed(int descriptor, std::uint32_t baud) {
  struct termios2 settings{};
  if (ioctl(descriptor, TCGETS2, &settings) != 0) return {errno, std::generic_category()};
  // The rate of input follows that of output where its own bits are clear.
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
  settings.c_cflag |= BOTHER;
  settings.c_ospeed = baud;
  settings.c_ispeed = baud;
  if (ioctl(descriptor, TCSETS2, &settings) != 0) return {errno, std::generic_category()};
  return {};
}

std::optional<std::uint32_t> tty_speed(int descriptor) {
  struct termios2 settings{};
  if (ioctl(descriptor, TCGETS2, &settings) != 0) return std::nullopt;
  return settings.c_ospeed;
}

}  // namespace cargobay::hal
