// The server: HTTP and WebSockets by libwebsockets, in one loop on one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/result.hpp"
#include "hal/web/gate.hpp"

namespace cargobay::web {

// Fewer than the clients of a feed (hal/feed/feed.hpp): others on this machine, who may have to
// stop the robot, find a place there.
inline constexpr std::size_t kMostWebSockets = 48;
// Requests whose headers are being read at a time; the next ones wait. One has 5 s.
inline constexpr unsigned kMostHandshakes = 16;
inline constexpr int kHandshakeSeconds = 5;
// Of the headers of a request.
inline constexpr unsigned kMostHeaderBytes = 4096;
// A client that does not answer a ping is gone.
inline constexpr int kPingSeconds = 2;
inline constexpr int kDeadSeconds = 5;

class Server {
 public:
  struct Options {
    Gate::Policy policy{};      // its port may be 0: any that is free
    std::string feed{};         // its port or socket; empty: the only one there is
    std::string certificate{};  // a PEM file with certificate and key; empty: without TLS
  };

  // Listens, and attaches to the feed when there is one. A failure says what to do.
  static hal::Result<std::unique_ptr<Server>> open(Options options);
  // Closes everything at once.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const Gate& gate() const;
  // With the port that was got, and without the token.
  std::string url() const;

  // Serves until `stop`, a descriptor, is readable; then tells the WebSockets, and returns when
  // they are closed, or after half a second. The thread that opened it.
  hal::Result<void> run(int stop);

 private:
  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace cargobay::web
