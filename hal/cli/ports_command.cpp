// `cargobay ports`: the serial ports of this machine.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

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

// An array of objects; what is not known of a port is left out.
std::string ports_json(const std::vector<hal::PortInfo>& ports) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const hal::PortInfo& port : ports) {
    nlohmann::ordered_json one{{"path", port.path}};
    if (!port.stable_path.empty()) one["always"] = port.stable_path;
    if (!port.description.empty()) one["description"] = port.description;
    if (port.usb_vendor_id != 0) {
      one["usb"] = {{"vendor_id", fmt::format("{:04x}", port.usb_vendor_id)},
                    {"product_id", fmt::format("{:04x}", port.usb_product_id)},
                    {"manufacturer", port.usb_manufacturer},
                    {"product", port.usb_product},
                    {"serial", port.usb_serial}};
    }
    list.push_back(std::move(one));
  }
  // A device names itself, and not always in UTF-8.
  return list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

int ports(bool as_json) {
  const std::vector<hal::PortInfo> found = hal::serial_ports();
  if (as_json) {
    fmt::print("{}", ports_json(found));
    return kSuccess;
  }
  for (const hal::PortInfo& port : found) print(port);
  if (found.empty()) fmt::print("no serial port here; for a virtual Create on one: cargobay sim\n");
  return kSuccess;
}

}  // namespace

void add_ports(CLI::App& app, Action& chosen) {
  auto as_json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "ports",
      "List the serial ports: path, USB ids and names, and the path that stays the same however "
      "they are plugged in.");
  command->add_flag("--json", *as_json, "Print them as a JSON array, with what is known of each");
  command->callback([as_json, &chosen] { chosen = [as_json] { return ports(*as_json); }; });
}

}  // namespace cargobay::cli
