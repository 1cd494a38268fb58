// How to recognise a port that was gone and came back: a USB adapter that is plugged in again may
// come back as another ttyUSBn, and another adapter under its old name.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hal/port/serial_transport.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

struct PortIdentity {
  enum class Kind : std::uint8_t {
    path,  // by its name: links, UARTs of the board, adapters that have a twin
    usb,   // by vendor, product and serial number
  };
  Kind kind = Kind::path;
  std::string path{};  // as it was given
  // The rest applies to USB adapters only; if `path` is a link, it is for messages alone.
  std::string linked{};       // where the link led; empty if `path` is not one
  std::string stable_path{};  // as in PortInfo; may be empty
  int usb_vendor_id = 0;
  int usb_product_id = 0;
  std::string usb_serial{};
};

// The identity of the port at `path`, while it is present; `ports` are all ports of the machine. A
// link, such as one under /dev/serial/by-id, was chosen by a user who wants it followed: it stays
// the name. An adapter is recognised as such only if no other in `ports` looks the same. Fails for
// the number of a pseudo-terminal, /dev/pts/3: whatever comes back under it may be unrelated.
Result<PortIdentity> identify(const std::string& path, const std::vector<PortInfo>& ports);

// Where the port is now. A failure says what is there instead: "/dev/ttyUSB0 is another adapter:
// serial number 5 instead of 3", also of a link that is gone; or that several look like it: the
// wrong one would move another robot. Its code is no_such_device only if nothing is there. Calls
// `ports` only if needed, once; blocks as long as that does; allocates.
Result<std::string> find_port(const PortIdentity& identity,
                              const std::function<std::vector<PortInfo>()>& ports);

}  // namespace cargobay::hal
