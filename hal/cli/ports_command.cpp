// `cargobay ports`: the serial ports of this machine.

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/port/serial_transport.hpp"

namespace cargobay::cli {
namespace {

void print(const hal::PortInfo& port) {
  fmt::print("{:<16}", port.path);
  if (port.usb_vendor_id != 0)
    fmt::print(" {:04x}:{:04x}", port.usb_vendor_id, port.usb_product_id);
  for (const std::string* word : {&port.usb_manufacturer, &port.usb_product, &port.usb_serial}) {
    if (!word->empty()) fmt::print(" {}", *word);
  }
  if (port.usb_product.empty() && !port.description.empty()) fmt::print(" {}", port.description);
  fmt::print("\n");
  if (!port.stable_path.empty()) fmt::print("  always {}\n", port.stable_path);
}

int ports() {
  const std::vector<hal::PortInfo> found = hal::serial_ports();
  for (const hal::PortInfo& port : found) print(port);
  if (found.empty()) fmt::print("no serial port here; for a virtual Create on one: cargobay sim\n");
  return kSuccess;
}

}  // namespace

void add_ports(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand(
      "ports",
      "List the serial ports: path, USB ids and names, and the path that stays the same however "
      "they are plugged in.");
  command->callback([&chosen] { chosen = ports; });
}

}  // namespace cargobay::cli
