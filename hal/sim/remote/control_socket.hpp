// The remote control of a served virtual Create over a Unix stream socket: text lines, as in
// hal/sim/remote/control.hpp, each answered before the next is read.
#pragma once

#include <poll.h>

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "hal/file/descriptor.hpp"
#include "hal/file/unix_listener.hpp"
#include "hal/result.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/remote/control_connection.hpp"

namespace cargobay::hal::sim {

class ControlSocket {
 public:
  // Listens on `path`, for this user only. A socket of this user that a dead process left there is
  // replaced, anything else refused. The server outlives the socket.
  static Result<std::unique_ptr<ControlSocket>> open(const std::string& path, Server& server);
  // Stops.
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  // Call it once.
  [[nodiscard]] std::error_code start();
  // Ends the thread, disconnects all clients, and removes the socket if it is still ours.
  // Idempotent.
  void stop();

 private:
  ControlSocket(Server& server, UnixListener listener, Descriptor wake);

  void run();
  // Waits until there is something to do: `sources` are, in order, wake-up, listener, clients.
  void wait(std::vector<pollfd>& sources) const;
  void accept_client();

  Server* server_;
  UnixListener listener_;
  Descriptor wake_;                           // an eventfd: ends the thread's sleep
  std::vector<ControlConnection> clients_{};  // used by the thread only
  rt::TimePoint accept_again_{};              // descriptors ran out: accept none before this time
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

// The answer of a served robot: `fault unplugged` takes the port away, `replugged` and `none` bring
// it back, everything else is control()'s.
std::string control(std::string_view line, Server& server);

}  // namespace cargobay::hal::sim
