// A real serial port, through libserialport.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

struct OpenedPort {
  std::unique_ptr<ByteStream> stream{};
  std::string remark{};  // one line on what will disturb the loop; empty if nothing will
};

// Opens `path`, which must not be a link, 8N1, raw, no flow control, at a baud rate of oi/baud.hpp,
// for this process alone: a second opener is refused, even root. Asks the driver for low latency.
// What had arrived before is dropped. Blocks for as long as the driver does; allocates. When the
// stream is destroyed, the port is set as it was found and released. libserialport is called only
// to set up and to change the rate; the control thread waits, reads and writes on the port's
// descriptor alone.
Result<OpenedPort> open_serial(const std::string& path, std::uint32_t baud);

struct PortInfo {
  std::string path{};
  std::string stable_path{};  // under /dev/serial/by-id: the same after replugging; may be empty
  std::string description{};
  std::string usb_manufacturer{};  // this and the rest: empty or 0 if it is not a USB adapter
  std::string usb_product{};
  std::string usb_serial{};
  int usb_vendor_id = 0;
  int usb_product_id = 0;
};

// The serial ports of this machine, sorted. Blocks for a few ms; allocates.
std::vector<PortInfo> serial_ports();

}  // namespace cargobay::hal
