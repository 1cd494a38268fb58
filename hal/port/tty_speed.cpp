#include "hal/port/tty_speed.hpp"

#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cerrno>

// <asm/termbits.h> and <termios.h> both define struct termios: nothing here may include the other.

namespace cargobay::hal {

namespace {

struct StandardRate {
  std::uint32_t baud;
  tcflag_t constant;
};

// Those of the robot's rates that termios has.
constexpr std::array<StandardRate, 10> kStandardRates{{{300, B300},
                                                       {600, B600},
                                                       {1200, B1200},
                                                       {2400, B2400},
                                                       {4800, B4800},
                                                       {9600, B9600},
                                                       {19200, B19200},
                                                       {38400, B38400},
                                                       {57600, B57600},
                                                       {115200, B115200}}};

// The rate as other programs see it: those that know only termios do not recognise BOTHER as a
// rate.
tcflag_t constant_of(std::uint32_t baud) {
  const auto* const standard =
      std::find_if(kStandardRates.begin(), kStandardRates.end(),
                   [baud](const StandardRate& rate) { return rate.baud == baud; });
  return standard == kStandardRates.end() ? tcflag_t{BOTHER} : standard->constant;
}

}  // namespace

std::error_code set_tty_speed(int descriptor, std::uint32_t baud) {
  struct termios2 settings{};
  if (ioctl(descriptor, TCGETS2, &settings) != 0) return {errno, std::generic_category()};
  // The input rate follows the output rate while its own bits are clear, and keeps following it
  // when a program that does not know these bits sets another rate.
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
  settings.c_cflag |= constant_of(baud);
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
