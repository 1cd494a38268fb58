// What systemd is told of a service of Type=notify: that it is ready, how it is, and that it lives.
// The protocol is that of sd_notify(3): one datagram each to the socket in $NOTIFY_SOCKET.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hal/file/descriptor.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// Of one thread. No function blocks or fails: what a manager that is too busy does not take is
// lost, and only the sign of life is repeated.
class ServiceManager {
 public:
  // The one that started this process; one that takes nothing if none did, or if it asked for
  // nothing. Reads the environment.
  ServiceManager();

  // The service does what it is for. Once is enough.
  void ready();
  // For people, in `systemctl status`; control characters become spaces.
  void status(std::string_view text);
  // It ends because it was asked to.
  void stopping();
  // Call it often: it tells the manager at most twice in each of its intervals. A service that does
  // not is killed by the manager, and started again.
  void alive(rt::TimePoint now);

 private:
  void send(const std::string& line);

  Descriptor socket_{};
  std::string address_;  // empty: nobody wants to know
  std::optional<rt::Duration> interval_{};
  std::optional<rt::TimePoint> last_sign_{};
};

}  // namespace cargobay::hal
