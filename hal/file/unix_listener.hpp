// A Unix stream socket at a path, on which other programs of this machine are listened for.
#pragma once

#include <sys/stat.h>

#include <string>

#include "hal/file/descriptor.hpp"
#include "hal/file/port_descriptor.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

class UnixListener {
 public:
  // Listens on `path`, with these rights from the first moment on. A socket of this user that a
  // dead process left there is replaced, anything else refused. Blocks for 50 ms at most if others
  // want the same path.
  static Result<UnixListener> open(const std::string& path, mode_t rights);
  // close().
  ~UnixListener() { close(); }
  UnixListener(UnixListener&&) noexcept = default;
  UnixListener& operator=(UnixListener&&) = delete;
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;

  // -1 after close().
  int descriptor() const { return listener_.number(); }
  const std::string& path() const { return path_; }
  // Who has come, neither blocking nor inherited; none (-1) with errno if nobody, or if the system
  // refuses.
  Descriptor accept() const;
  // Removes the socket's file if it is still ours. Idempotent.
  void close();

 private:
  UnixListener(std::string path, Descriptor listener);
  Result<void> bind_to_path(mode_t rights);

  std::string path_;
  Descriptor listener_;
  PortDescriptor for_children_;  // closed in a forked child, which would seem to listen on
  struct stat file_{};           // the socket's own file, at that path
};

// A connection to the socket at the path, as accept() returns them; none (-1) with errno. Never
// waits: a socket whose queue is full is EAGAIN.
Descriptor connect_to(const std::string& path);

}  // namespace cargobay::hal
