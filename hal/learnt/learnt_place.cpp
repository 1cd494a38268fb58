#include "hal/learnt/learnt_place.hpp"

#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "hal/port/pty_transport.hpp"
#include "hal/port/serial_transport.hpp"

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
  const char* const value = secure_getenv(name);  // NOLINT(concurrency-mt-unsafe): set-up
  return value == nullptr ? "" : value;
}

// Of a path that names one folder wherever the program was started.
bool is_absolute(const std::string& path) { return path.starts_with('/'); }

// One name of a file for each text: "/dev/ttyUSB0" is "dev-ttyUSB0".
std::string file_name(const std::string& port) {
  std::string name;
  for (const char character : port.substr(port.starts_with('/') ? 1 : 0)) {
    const auto byte = static_cast<unsigned char>(character);
    if (character == '/') {
      name += '-';
    } else if (std::isalnum(byte) != 0 || (character == '.' && !name.empty()) || character == '_') {
      name += character;
    } else {
      std::array<char, 4> escaped{};
      std::snprintf(escaped.data(), escaped.size(), "%%%02X", byte);
      name += escaped.data();
    }
  }
  return name + ".toml";
}

// Of a descriptor, /proc/self/fd/5, what was opened.
std::string opened_as(const std::string& port) {
  if (!port.starts_with("/proc/self/fd/")) return port;
  std::error_code error;
  const fs::path opened = fs::read_symlink(port, error);
  return error ? port : opened.string();
}

}  // namespace

std::string port_name(const PortIdentity& identity) {
  if (identity.kind == PortIdentity::Kind::usb) {
    std::array<char, 16> numbers{};
    std::snprintf(numbers.data(), numbers.size(), "%04x:%04x",
                  static_cast<unsigned>(identity.usb_vendor_id) & 0xFFFFU,
                  static_cast<unsigned>(identity.usb_product_id) & 0xFFFFU);
    return "usb " + std::string{numbers.data()} + " " + identity.usb_serial;
  }
  std::error_code error;
  const fs::path path = fs::absolute(identity.path, error);
  return error ? identity.path : path.lexically_normal().string();
}

std::string state_folder() {
  if (const std::string own = variable("STATE_DIRECTORY"); is_absolute(own))
    return own.substr(0, own.find(':'));
  if (const std::string xdg = variable("XDG_STATE_HOME"); is_absolute(xdg))
    return xdg + "/cargobay";
  if (const std::string home = variable("HOME"); is_absolute(home) && home != "/")
    return home + "/.local/state/cargobay";
  return "/var/lib/cargobay";
}

LearntPlace learnt_place(const std::string& wish, const std::string& port) {
  const std::string opened = opened_as(port);
  const bool is_virtual = opened.empty() || is_pty(opened);
  if (wish == "none" || (wish.empty() && is_virtual)) return {};
  if (is_virtual) return {.file = wish, .port = "a virtual Create"};
  const auto identity = identify(opened, serial_ports());
  const std::string name = identity ? port_name(*identity) : opened;
  if (!wish.empty()) return {.file = wish, .port = name};
  return {.file = state_folder() + "/learnt/" + file_name(name), .port = name};
}

}  // namespace cargobay::hal
