#include "hal/port/port_identity.hpp"

#include <algorithm>
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

}  // namespace

Result<PortIdentity> identify(const std::string& path, const std::vector<PortInfo>& ports) {
  PortIdentity identity{.path = path};
  std::error_code error;
  if (fs::is_symlink(path, error)) return identity;
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
  identity.usb_vendor_id = port->usb_vendor_id;
  identity.usb_product_id = port->usb_product_id;
  identity.usb_serial = port->usb_serial;
  return identity;
}

std::optional<std::string> find_port(const PortIdentity& identity,
                                     const std::function<std::vector<PortInfo>()>& ports) {
  if (identity.kind != PortIdentity::Kind::usb) {
    if (!exists(identity.path)) return std::nullopt;
    return identity.path;
  }
  // Listing all ports takes milliseconds, checking for a link microseconds.
  if (!identity.stable_path.empty() && !exists(identity.stable_path)) return std::nullopt;
  const PortInfo wanted{.usb_serial = identity.usb_serial,
                        .usb_vendor_id = identity.usb_vendor_id,
                        .usb_product_id = identity.usb_product_id};
  std::vector<PortInfo> alike = ports();
  std::erase_if(alike, [&](const PortInfo& port) { return !same_adapter(port, wanted); });
  if (alike.size() != 1) return std::nullopt;
  return alike.front().path;
}

}  // namespace cargobay::hal
