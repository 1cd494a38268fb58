// A client of the control socket: one line out, one line back.
#pragma once

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <string>

namespace cargobay::hal::sim::test {

class Caller {
 public:
  explicit Caller(const std::string& path)
      : descriptor_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    connected_ =
        ::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const timeval patience{.tv_sec = 10, .tv_usec = 0};
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~Caller() { close(descriptor_); }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;

  bool connected() const { return connected_; }
  void send(const std::string& text) const {
    (void)::send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL);
  }
  // SHUT_RD or SHUT_WR: nothing more in that direction.
  void shut_down(int direction) const { (void)shutdown(descriptor_, direction); }
  // The next line; empty if none comes.
  std::string receive() const {
    std::string line;
    char character = 0;
    while (recv(descriptor_, &character, 1, 0) == 1 && character != '\n') line += character;
    return line;
  }
  std::string ask(const std::string& line) const {
    send(line + "\n");
    return receive();
  }

 private:
  int descriptor_;
  bool connected_ = false;
};

}  // namespace cargobay::hal::sim::test
