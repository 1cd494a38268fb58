#include "hal/port/port_identity.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include "hal/port/pty_transport.hpp"

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;

bool exists(const std::string& path) {
  std::error_code unreachable;
  return fs::exists(path, unreachable);
}

// Empty strings match too: many adapters have no serial number.
bool same_adapter(const PortInfo& a, const PortInfo& b) {
  return a.usb_vendor_id == b.usb_vendor_id && a.usb_product_id == b.usb_product_id &&
         a.usb_serial == b.usb_serial;
}

bool is_known_adapter(const PortInfo& port) { return port.usb_vendor_id != 0; }

PortInfo adapter_of(const PortIdentity& identity) {
  return {.usb_serial = identity.usb_serial,
          .usb_vendor_id = identity.usb_vendor_id,
          .usb_product_id = identity.usb_product_id};
}

// "0403:6001"
std::string model(const PortInfo& port) {
  std::array<char, 16> text{};
  (void)std::snprintf(text.data(), text.size(), "%04x:%04x",  // it fits
                      static_cast<unsigned>(port.usb_vendor_id) & 0xffffU,
                      static_cast<unsigned>(port.usb_product_id) & 0xffffU);
  return text.data();
}

void note_adapter(PortIdentity& identity, const PortInfo& port) {
  identity.usb_vendor_id = port.usb_vendor_id;
  identity.usb_product_id = port.usb_product_id;
  identity.usb_serial = port.usb_serial;
}

std::string difference(const PortInfo& there, const PortInfo& wanted) {
  if (!is_known_adapter(there)) return "not a USB adapter";
  if (model(there) != model(wanted)) return "USB " + model(there) + " instead of " + model(wanted);
  const auto serial = [](const PortInfo& port) {
    return port.usb_serial.empty() ? "none" : port.usb_serial;
  };
  return "serial number " + serial(there) + " instead of " + serial(wanted);
}

}  // namespace

Result<PortIdentity> identify(const std::string& path, const std::vector<PortInfo>& ports) {
  PortIdentity identity{.path = path};
  std::error_code error;
  if (fs::is_symlink(path, error)) {
    const std::string linked = fs::canonical(path, error).string();
    const auto port = std::ranges::find(ports, linked, &PortInfo::path);
    if (port == ports.end() || !is_known_adapter(*port)) return identity;
    identity.linked = linked;
    note_adapter(identity, *port);
    return identity;
  }
  if (is_pty(path)) {
    return Failure{path +
                   " may be another program's terminal when it comes back; name the port by a "
                   "link, such as that of cargobay sim --link"};
  }
  const auto port = std::ranges::find(ports, path, &PortInfo::path);
  if (port == ports.end() || !is_known_adapter(*port)) return identity;
  const auto alike = std::ranges::count_if(
      ports, [&](const PortInfo& other) { return same_adapter(other, *port); });
  if (alike > 1) return identity;
  identity.kind = PortIdentity::Kind::usb;
  identity.stable_path = port->stable_path;
  note_adapter(identity, *port);
  return identity;
}

namespace {

constexpr const char* kPlugIn = "; plug in the robot's, or start again with this one";

// Of a link that is gone, or leads nowhere.
Failure lost_link(const PortIdentity& identity,
                  const std::function<std::vector<PortInfo>()>& ports) {
  Failure gone{identity.path + " is not there", std::make_error_code(std::errc::no_such_device)};
  if (identity.linked.empty() || !exists(identity.linked)) return gone;
  const std::vector<PortInfo> all = ports();
  const auto there = std::ranges::find(all, identity.linked, &PortInfo::path);
  if (there == all.end()) return gone;
  const PortInfo wanted = adapter_of(identity);
  if (same_adapter(*there, wanted)) return {identity.path + " is not there yet"};
  return {identity.path + " is not there, and " + identity.linked +
          " is another adapter: " + difference(*there, wanted) + kPlugIn};
}

}  // namespace

Result<std::string> find_port(const PortIdentity& identity,
                              const std::function<std::vector<PortInfo>()>& ports) {
  Failure gone{identity.path + " is not there", std::make_error_code(std::errc::no_such_device)};
  const bool is_there = exists(identity.path);
  if (identity.kind != PortIdentity::Kind::usb) {
    if (!is_there) return lost_link(identity, ports);
    return identity.path;
  }
  // Listing all ports takes milliseconds, checking for a link microseconds.
  const bool linked = identity.stable_path.empty() || exists(identity.stable_path);
  if (!linked && !is_there) return gone;
  const PortInfo wanted = adapter_of(identity);
  const std::vector<PortInfo> all = ports();
  std::vector<PortInfo> alike = all;
  std::erase_if(alike, [&](const PortInfo& port) { return !same_adapter(port, wanted); });
  if (alike.size() > 1) {
    return Failure{std::to_string(alike.size()) + " adapters look like that of " + identity.path +
                   "; unplug those that are not the robot's"};
  }
  if (alike.size() == 1) {
    if (linked) return alike.front().path;
    return Failure{identity.stable_path + " is not there yet"};
  }
  const auto there = std::ranges::find(all, identity.path, &PortInfo::path);
  if (there == all.end()) return gone;
  return Failure{identity.path + " is another adapter: " + difference(*there, wanted) + kPlugIn};
}

}  // namespace cargobay::hal
