// The remote control of a served virtual Create over a Unix stream socket: text lines, as
// hal/sim/remote/control.hpp has them, each answered before the next is read.
#pragma once

#include <poll.h>
#include <sys/stat.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "hal/result.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/remote/control_connection.hpp"

namespace cargobay::hal::sim {

class ControlSocket {
 public:
  // Listens on `path`, for this user alone. A socket of this user's that a process which is gone
  // left there is replaced, anything else refused. The server outlives the socket.
  static Result<std::unique_ptr<ControlSocket>> open(const std::string& path, Server& server);
  // Stops.
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  // To be called once.
  [[nodiscard]] std::error_code start();
  // Ends the thread, hangs up on who is connected, and removes the socket, if it is still ours.
  // Idempotent.
  void stop();

 private:
  ControlSocket(std::string path, Server& server, int listener, int wake_descriptor);

  std::optional<Failure> listen_on_path();
  void run();
  // Until there is something to do. What there is, in the order of wake-up, listener, clients.
  void wait(std::vector<pollfd>& sources) const;
  void accept_client();

  std::string path_;
  struct stat file_{};  // the socket's own, at that path
  Server* server_;
  int listener_;
  int wake_descriptor_;
  std::vector<ControlConnection> clients_{};  // the thread's own
  rt::TimePoint accept_again_{};              // descriptors ran out: not before
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

// The answer of a served robot: `fault unplugged` takes the port away, `replugged` and `none` bring
// it back, all else is control()'s.
std::string control(std::string_view line, Server& server);

}  // namespace cargobay::hal::sim
