#include <system_error>

#include "gpio/line.hpp"

namespace cargobay::gpio {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

// What helps depends on who may open the device file.
std::string permission_remedy(const std::string& group) {
  if (!group.empty() && group != "root") {
    return "join the group " + group + " (sudo adduser $USER " + group + ") and log in again";
  }
  return "give the group dialout access: the package cargobay installs a udev rule for that; by "
         "hand, "
         "copy examples/system/60-cargobay.rules to /etc/udev/rules.d, then: "
         "sudo udevadm control --reload && sudo udevadm trigger";
}

}  // namespace

std::string explain(const LineError& error) {
  const LineAddress& address = error.address;
  const std::string line =
      "line " + address.line + (address.chip.empty() ? "" : " of chip " + address.chip);
  switch (error.kind) {
    case LineError::Kind::no_chips:
      return "cannot use " + line +
             ": this machine has no GPIO chip (/dev/gpiochip*); "
             "run it where the line is, or leave the pin out";
    case LineError::Kind::no_such_chip:
      return "no GPIO chip has the label or name " + address.chip +
             "; available: " + listed(error.candidates);
    case LineError::Kind::ambiguous_chip:
      return "several GPIO chips have the label " + address.chip +
             "; name one of them: " + listed(error.candidates);
    case LineError::Kind::no_such_line:
      return "no " + line + "; available: " + listed(error.candidates) +
             "; list the lines with: cargobay pins";
    case LineError::Kind::ambiguous_line:
      return "several GPIO lines are called " + address.line +
             "; give chip and offset of one of them: " + listed(error.candidates);
    case LineError::Kind::busy:
      return line + " is in use by " +
             (error.holder.empty() ? "a process that the kernel does not name" : error.holder) +
             "; end that program, or choose another line";
    case LineError::Kind::no_permission:
      return "no permission to use " + error.path + "; " + permission_remedy(error.group);
    case LineError::Kind::system: break;
  }
  return "cannot use " + line + ": " +
         std::error_code{error.error, std::generic_category()}.message() +
         "; see what the kernel says with: dmesg | tail";
}

}  // namespace cargobay::gpio
