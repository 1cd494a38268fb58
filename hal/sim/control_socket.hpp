// The remote control of a served virtual Create over a Unix stream socket: text lines, as
// hal/sim/control.hpp has them, each answered before the next is read.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "hal/result.hpp"
#include "hal/sim/server.hpp"

namespace cargobay::hal::sim {

class ControlSocket {
 public:
  // Listens on `path`, for this user alone. A socket left there by a process that is gone is
  // replaced, anything else refused. The server outlives the socket.
  static Result<std::unique_ptr<ControlSocket>> open(const std::string& path, Server& server);
  // Stops.
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  // To be called once.
  [[nodiscard]] std::error_code start();
  // Ends the thread, hangs up on who is connected, and removes the socket. Idempotent.
  void stop();

 private:
  struct Client {
    int descriptor = -1;
    std::string received{};  // of a line whose end has not come
    bool too_long = false;   // the rest of that line is passed over
  };

  ControlSocket(std::string path, Server& server, int listener, int wake_descriptor);

  void run();
  void accept_client();
  // False where the client is gone.
  bool serve(Client& client);
  bool answer(Client& client, std::string_view line);

  std::string path_;
  Server* server_;
  int listener_;
  int wake_descriptor_;
  std::vector<Client> clients_{};  // the thread's own
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

// The answer of a served robot: `fault unplugged` takes the port away, `replugged` and `none` bring
// it back, all else is control()'s.
std::string control(std::string_view line, Server& server);

}  // namespace cargobay::hal::sim
