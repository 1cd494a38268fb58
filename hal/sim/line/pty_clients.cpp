#include "hal/sim/line/pty_clients.hpp"

#include <asm/ioctls.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "hal/file/port_descriptor.hpp"

namespace cargobay::hal::sim {

namespace {

// A program that takes exclusive use of the port (TIOCEXCL) does so right after opening it. If that
// happened during a look, it would lock us out.
constexpr rt::Duration kSettling = std::chrono::milliseconds{10};
// If clients keep coming, it never settles.
constexpr rt::Duration kLongestSettling = std::chrono::milliseconds{50};
// Looks without a hint, in case a hint came during a look and was missed.
constexpr rt::Duration kLookAgain = std::chrono::milliseconds{250};

// Whether no process has the other end open.
bool open_nowhere(int master) {
  pollfd port{.fd = master, .events = 0, .revents = 0};
  return poll(&port, 1, 0) > 0 && (port.revents & POLLHUP) != 0;
}

}  // namespace

std::error_code PtyClients::open() {
  // First of all: a master whose other end was never open does not report that nothing has it open.
  reopen();
  if (own_ < 0) return {errno, std::generic_category()};
  watch_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (watch_ >= 0 && inotify_add_watch(watch_, path_.c_str(), IN_OPEN | IN_CLOSE) < 0) {
    close(watch_);
    watch_ = -1;
  }
  return {};
}

PtyClients::~PtyClients() {
  for (const int descriptor : {watch_, own_}) {
    if (descriptor >= 0) close(descriptor);
  }
}

void PtyClients::reopen() {
  // Not by its path: during look() even we may not be allowed to open that.
  const StandardNumbersTaken taken;
  own_ = ioctl(master_, TIOCGPTPEER, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
}

PtyClients::Hints PtyClients::hints() const {
  Hints hints;
  alignas(inotify_event) std::array<char, 4096> events{};
  for (;;) {
    const ssize_t length = read(watch_, events.data(), events.size());
    if (length <= 0) return hints;
    for (std::size_t at = 0; at + sizeof(inotify_event) <= static_cast<std::size_t>(length);) {
      inotify_event event{};
      std::memcpy(&event, events.data() + at, sizeof event);
      hints.opened = hints.opened || (event.mask & IN_OPEN) != 0;
      hints.closed = hints.closed || (event.mask & (IN_CLOSE | IN_Q_OVERFLOW)) != 0;
      at += sizeof event + event.len;
    }
  }
}

void PtyClients::hint(rt::TimePoint now) {
  if (!hinted_) hinted_at_ = settled_at_ = now;
  hinted_ = true;
}

void PtyClients::note_arrival(rt::TimePoint now) {
  hint(now);
  present_ = true;  // if it has already gone, the look will show it
  settled_at_ = std::min(now + kSettling, hinted_at_ + kLongestSettling);
}

void PtyClients::heard(rt::TimePoint now) {
  if (!present_) note_arrival(now);
}

void PtyClients::update(rt::TimePoint now) {
  const Hints seen = hints();
  if (seen.closed) hint(now);
  if (seen.opened) note_arrival(now);
  if (now < next_update() && own_ >= 0) return;
  const bool before = present_;
  present_ = look();
  if (before && !present_) tcflush(own_, TCIFLUSH);
  (void)hints();  // discards those that the look itself caused
  hinted_ = false;
  look_again_at_ = now + kLookAgain;
}

// A look interrupts exclusive use, or we could not reopen our end. Meanwhile the file's mode keeps
// out the programs that exclusive use kept out. Exclusive use ends before we know whether there is
// a client, never after: a client that came in between could lose its own.
bool PtyClients::look() {
  struct stat file{};
  int exclusive = 0;
  if (own_ >= 0) {
    ioctl(own_, TIOCGEXCL, &exclusive);
    if (exclusive != 0 && fstat(own_, &file) != 0) exclusive = 0;
    if (exclusive != 0) {
      (void)fchmod(own_, 0);  // refused if the file is not ours: unguarded for a moment
      ioctl(own_, TIOCNXCL);
    }
    close(own_);
  }
  const bool present = !open_nowhere(master_);
  reopen();
  if (exclusive != 0) {
    if (present) ioctl(own_, TIOCEXCL);
    (void)chmod(path_.c_str(), file.st_mode & 07777U);  // fails only if fchmod() did
  }
  return present;
}

}  // namespace cargobay::hal::sim
