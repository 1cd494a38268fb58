#include "hal/port/tty_stream.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "hal/port/tty_speed.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

// The driver's queue is not the last one: a UART has a FIFO of its own. A port that cannot report
// its state counts as empty.
bool hardware_is_empty(int descriptor) {
  int state = 0;
  return ioctl(descriptor, TIOCSERGETLSR, &state) != 0 || (state & TIOCSER_TEMT) != 0;
}

}  // namespace

// The one place where the control thread sleeps.
ByteStream::Wait TtyStream::wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING {
  return rt::unchecked([this, deadline]() noexcept {
    for (;;) {
      const rt::Duration left = std::max(deadline - rt::Clock::now(), rt::Duration::zero());
      const timespec timeout = rt::as_timespec(left);
      pollfd port{.fd = descriptor_, .events = POLLIN, .revents = 0};
      const int ready = ppoll(&port, 1, &timeout, nullptr);
      if (ready < 0 && errno == EINTR) continue;
      if (ready == 0) return Wait::timed_out;
      // A closed master reports POLLIN with POLLHUP at once and for ever: never poll it again.
      const bool gone = ready < 0 || (port.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
      return gone ? Wait::hung_up : Wait::ready;
    }
  });
}

ByteStream::Transfer TtyStream::read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  return rt::unchecked([this, bytes]() noexcept -> Transfer {
    const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) return {.count = static_cast<std::size_t>(count)};
    return {.error = errno == EAGAIN || errno == EINTR ? 0 : errno};
  });
}

ByteStream::Transfer TtyStream::write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  return rt::unchecked([this, bytes]() noexcept -> Transfer {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) return {.count = static_cast<std::size_t>(count)};
    return {.error = errno == EINTR ? EAGAIN : errno};
  });
}

rt::TimePoint TtyStream::now() const CARGOBAY_NONBLOCKING {
  return rt::unchecked([]() noexcept { return rt::Clock::now(); });
}

bool TtyStream::still_open() const CARGOBAY_NONBLOCKING {
  return rt::unchecked([this]() noexcept { return !lock_ || lock_->still_open(); });
}

std::error_code TtyStream::set_baud(std::uint32_t baud) {
  if (!still_open()) return {EBADF, std::generic_category()};
  const std::error_code error = apply_baud(baud);
  if (!error) baud_ = baud;
  return error;
}

// poll() honours VMIN if VTIME is 0 (n_tty_poll).
std::error_code TtyStream::set_wake_threshold(std::size_t bytes) {
  if (!still_open()) return {EBADF, std::generic_category()};
  termios settings{};
  if (tcgetattr(descriptor_, &settings) != 0) return {errno, std::generic_category()};
  settings.c_cc[VMIN] = static_cast<cc_t>(std::clamp<std::size_t>(bytes, 1, 255));
  settings.c_cc[VTIME] = 0;
  // A rate without a constant is not in termios; some C libraries lose it here.
  if (tcsetattr(descriptor_, TCSANOW, &settings) != 0) return {errno, std::generic_category()};
  return set_tty_speed(descriptor_, baud_);
}

std::error_code TtyStream::set_modem_line(ModemLine line, bool asserted) {
  if (!still_open()) return {EBADF, std::generic_category()};
  int bits = line == ModemLine::rts ? TIOCM_RTS : TIOCM_DTR;
  if (ioctl(descriptor_, asserted ? TIOCMBIS : TIOCMBIC, &bits) != 0)
    return {errno, std::generic_category()};
  return lock_ ? lock_->keep_modem_lines() : std::error_code{};
}

void TtyStream::discard_input() {
  if (still_open()) tcflush(descriptor_, TCIFLUSH);
}

bool TtyStream::drain(rt::Duration timeout) {
  const rt::TimePoint deadline = rt::Clock::now() + timeout;
  for (;;) {
    int waiting = 0;
    if (ioctl(descriptor_, TIOCOUTQ, &waiting) != 0) return false;
    if (waiting == 0 && hardware_is_empty(descriptor_)) return true;
    if (rt::Clock::now() >= deadline) return false;
    sleep(std::chrono::microseconds{500});
  }
}

void TtyStream::sleep(rt::Duration duration) {
  const timespec pause = rt::as_timespec(std::max(duration, rt::Duration::zero()));
  nanosleep(&pause, nullptr);
}

}  // namespace cargobay::hal
