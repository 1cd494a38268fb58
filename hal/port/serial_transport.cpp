#include "hal/port/serial_transport.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include <libserialport.h>

#include "hal/port/low_latency.hpp"
#include "hal/port/port_lock.hpp"
#include "hal/port/tty_stream.hpp"

namespace cargobay::hal {
namespace {

struct FreePort {
  void operator()(sp_port* port) const { sp_free_port(port); }
};
struct ClosePort {
  PortDescriptor opened{};  // by libserialport, which knows only its number
  void operator()(sp_port* port) const {
    if (opened.still_open()) sp_close(port);
    sp_free_port(port);
  }
};
struct FreeConfig {
  void operator()(sp_port_config* config) const { sp_free_config(config); }
};
using OpenPort = std::unique_ptr<sp_port, ClosePort>;
using PortConfig = std::unique_ptr<sp_port_config, FreeConfig>;

constexpr int kLongestGoodTimerMs = 2;

// Call right after the function that failed.
std::error_code error_of(sp_return result) {
  switch (result) {
    case SP_OK: return {};
    case SP_ERR_ARG: return std::make_error_code(std::errc::invalid_argument);
    case SP_ERR_MEM: return std::make_error_code(std::errc::not_enough_memory);
    case SP_ERR_SUPP: return std::make_error_code(std::errc::not_supported);
    case SP_ERR_FAIL: break;
  }
  const int code = sp_last_error_code();
  return {code != 0 ? code : EIO, std::generic_category()};
}

// 8N1, no flow control, at this rate.
sp_return configure(sp_port* port, std::uint32_t baud) {
  sp_port_config* raw = nullptr;
  if (const sp_return result = sp_new_config(&raw); result != SP_OK) return result;
  const PortConfig config{raw};
  // The setters fail only for a null pointer.
  (void)sp_set_config_baudrate(raw, static_cast<int>(baud));
  (void)sp_set_config_bits(raw, 8);
  (void)sp_set_config_parity(raw, SP_PARITY_NONE);
  (void)sp_set_config_stopbits(raw, 1);
  (void)sp_set_config_flowcontrol(raw, SP_FLOWCONTROL_NONE);
  return sp_set_config(port, raw);
}

class SerialTransport final : public TtyStream {
 public:
  SerialTransport(std::unique_ptr<PortLock> lock, OpenPort port, std::uint32_t baud)
      : TtyStream{lock->descriptor(), baud, std::move(lock)}, port_{std::move(port)} {}

 private:
  std::error_code apply_baud(std::uint32_t baud) override {
    if (!port_.get_deleter().opened.still_open()) return {EBADF, std::generic_category()};
    return error_of(sp_set_baudrate(port_.get(), static_cast<int>(baud)));
  }

  OpenPort port_;  // closed before the lock restores the port
};

std::string timer_remark(const std::string& path, int timer_ms) {
  return "the adapter at " + path + " holds bytes back for " + std::to_string(timer_ms) +
         " ms (FTDI latency timer), the robot's period is 15 ms; shorten it: echo 1 | sudo tee "
         "/sys/class/tty/" +
         path.substr(path.rfind('/') + 1) + "/device/latency_timer";
}

std::string text(const char* text_or_null) { return text_or_null == nullptr ? "" : text_or_null; }

// The link under /dev/serial/by-id that leads to the port.
std::string stable_path(const std::string& path) {
  std::error_code error;
  for (const auto& link : std::filesystem::directory_iterator{"/dev/serial/by-id", error}) {
    std::error_code ignored;
    if (std::filesystem::canonical(link.path(), ignored) == path) return link.path().string();
  }
  return "";
}

PortInfo describe(const sp_port* port) {
  PortInfo info{.path = text(sp_get_port_name(port)),
                .description = text(sp_get_port_description(port))};
  info.stable_path = stable_path(info.path);
  if (sp_get_port_transport(port) != SP_TRANSPORT_USB) return info;
  info.usb_manufacturer = text(sp_get_port_usb_manufacturer(port));
  info.usb_product = text(sp_get_port_usb_product(port));
  info.usb_serial = text(sp_get_port_usb_serial(port));
  (void)sp_get_port_usb_vid_pid(port, &info.usb_vendor_id, &info.usb_product_id);  // 0 if unknown
  return info;
}

}  // namespace

Result<OpenedPort> open_serial(const std::string& path, std::uint32_t baud) {
  auto lock = PortLock::take(path);
  if (!lock) return lock.failure();
  const auto refuse = [&path](std::error_code error) { return cannot_open(path, error); };
  sp_port* raw = nullptr;
  if (const sp_return result = sp_get_port_by_name(path.c_str(), &raw); result != SP_OK) {
    return Failure{
        "cannot open " + path +
            ": the kernel does not list it as a serial port; list the ports with: cargobay ports",
        error_of(result)};
  }
  std::unique_ptr<sp_port, FreePort> unopened{raw};
  (*lock)->let_go();
  const StandardNumbersTaken taken;
  if (const sp_return result = sp_open(raw, SP_MODE_READ_WRITE); result != SP_OK) {
    return refuse(error_of(result));
  }
  int descriptor = -1;
  (void)sp_get_port_handle(raw, &descriptor);  // cannot fail for an open port
  OpenPort port{unopened.release(), ClosePort{PortDescriptor::borrow(descriptor)}};
  if (const std::error_code error = (*lock)->hand_over(descriptor)) return refuse(error);
  if (const sp_return refused = configure(raw, baud); refused != SP_OK) {
    const std::error_code reason = error_of(refused);
    return Failure{path + " does not run at " + std::to_string(baud) + " baud: " + reason.message(),
                   reason};
  }
  ask_for_low_latency((*lock)->descriptor());
  OpenedPort opened;
  opened.stream = std::make_unique<SerialTransport>(std::move(*lock), std::move(port), baud);
  // libserialport leaves VMIN at 0: poll() would wake with nothing to read.
  if (const std::error_code refused = opened.stream->set_wake_threshold(1); refused)
    return refuse(refused);
  opened.stream->discard_input();
  const auto timer_ms =
      shorten_latency_timer("/sys/class/tty/" + path.substr(path.rfind('/') + 1) + "/device");
  if (timer_ms.has_value() && *timer_ms > kLongestGoodTimerMs)
    opened.remark = timer_remark(path, *timer_ms);
  return opened;
}

std::vector<PortInfo> serial_ports() {
  std::vector<PortInfo> ports;
  sp_port** list = nullptr;
  if (sp_list_ports(&list) != SP_OK) return ports;
  for (sp_port** port = list; *port != nullptr; ++port) ports.push_back(describe(*port));
  sp_free_port_list(list);
  std::sort(ports.begin(), ports.end(),
            [](const PortInfo& a, const PortInfo& b) { return a.path < b.path; });
  return ports;
}

}  // namespace cargobay::hal
