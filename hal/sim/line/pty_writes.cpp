#include "hal/sim/line/pty_writes.hpp"

#include <sys/inotify.h>
#include <unistd.h>

#include <array>

#include "hal/file/port_descriptor.hpp"

namespace cargobay::hal::sim {

namespace {

// -1 if the kernel refuses.
int watch_writes(const std::string& path) {
  const StandardNumbersTaken taken;
  const int watch = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (watch < 0 || inotify_add_watch(watch, path.c_str(), IN_MODIFY) >= 0) return watch;
  close(watch);
  return -1;
}

}  // namespace

PtyWrites::PtyWrites(const std::string& path) : watch_{watch_writes(path)} {}

PtyWrites::~PtyWrites() {
  if (watch_ >= 0) close(watch_);
}

bool PtyWrites::any() {
  alignas(inotify_event) std::array<char, 1024> events{};
  bool written = false;
  while (watch_ >= 0 && read(watch_, events.data(), events.size()) > 0) written = true;
  return written;
}

}  // namespace cargobay::hal::sim
