#include "hal/pty_transport.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <optional>

#include "hal/tty_speed.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

class PtyTransport final : public ByteStream {
 public:
  PtyTransport(int descriptor, std::uint32_t baud) : descriptor_{descriptor}, baud_{baud} {}
  PtyTransport(const PtyTransport&) = delete;
  PtyTransport& operator=(const PtyTransport&) = delete;
  ~PtyTransport() override {
    if (ours_) give_back();
    close(descriptor_);
  }

  // Takes the port for this process alone, and sets it up. Returns an errno.
  int take();

  Wait wait(rt::TimePoint deadline) noexcept CARGOBAY_NONBLOCKING override;
  Transfer read(std::span<std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override;
  rt::TimePoint now() const noexcept CARGOBAY_NONBLOCKING override;

  std::uint32_t baud() const override { return baud_; }
  std::error_code set_baud(std::uint32_t baud) override;
  std::error_code set_wake_threshold(std::size_t bytes) override;
  void discard_input() override { tcflush(descriptor_, TCIFLUSH); }
  bool drain(rt::Duration timeout) override;

 private:
  void give_back();

  int descriptor_;
  std::uint32_t baud_;
  bool ours_ = false;
  termios found_{};  // how the port was found, and is left
  std::optional<std::uint32_t> found_speed_{};
};

// The one place where the control thread sleeps.
ByteStream::Wait PtyTransport::wait(rt::TimePoint deadline) noexcept CARGOBAY_NONBLOCKING {
  return rt::unchecked([this, deadline]() noexcept {
    for (;;) {
      const rt::Duration left = std::max(deadline - rt::Clock::now(), rt::Duration::zero());
      const timespec timeout{.tv_sec = static_cast<time_t>(left.count() / 1'000'000'000),
                             .tv_nsec = static_cast<long>(left.count() % 1'000'000'000)};
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

ByteStream::Transfer PtyTransport::read(std::span<std::uint8_t> bytes) noexcept
    CARGOBAY_NONBLOCKING {
  return rt::unchecked([this, bytes]() noexcept -> Transfer {
    const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) return {.count = static_cast<std::size_t>(count)};
    return {.error = errno == EAGAIN || errno == EINTR ? 0 : errno};
  });
}

ByteStream::Transfer PtyTransport::write(std::span<const std::uint8_t> bytes) noexcept
    CARGOBAY_NONBLOCKING {
  return rt::unchecked([this, bytes]() noexcept -> Transfer {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) return {.count = static_cast<std::size_t>(count)};
    return {.error = errno == EINTR ? EAGAIN : errno};
  });
}

rt::TimePoint PtyTransport::now() const noexcept CARGOBAY_NONBLOCKING {
  return rt::unchecked([]() noexcept { return rt::Clock::now(); });
}

std::error_code PtyTransport::set_baud(std::uint32_t baud) {
  const std::error_code error = set_tty_speed(descriptor_, baud);
  if (!error) baud_ = baud;
  return error;
}

// VMIN with VTIME 0 is honoured by poll() (n_tty_poll).
std::error_code PtyTransport::set_wake_threshold(std::size_t bytes) {
  termios settings{};
  if (tcgetattr(descriptor_, &settings) != 0) return {errno, std::generic_category()};
  settings.c_cc[VMIN] = static_cast<cc_t>(std::clamp<std::size_t>(bytes, 1, 255));
  settings.c_cc[VTIME] = 0;
  // tcsetattr would set the rate to one of its constants; the rate is set anew behind it.
  if (tcsetattr(descriptor_, TCSANOW, &settings) != 0) return {errno, std::generic_category()};
  return set_tty_speed(descriptor_, baud_);
}

bool PtyTransport::drain(rt::Duration timeout) {
  const rt::TimePoint deadline = rt::Clock::now() + timeout;
  for (;;) {
    int waiting = 0;
    if (ioctl(descriptor_, TIOCOUTQ, &waiting) != 0) return false;
    if (waiting == 0) return true;
    if (rt::Clock::now() >= deadline) return false;
    const timespec pause{.tv_sec = 0, .tv_nsec = 500'000};
    nanosleep(&pause, nullptr);
  }
}

Failure cannot_open(const std::string& path, int error) {
  const std::error_code code{error, std::generic_category()};
  const std::string what = "cannot open " + path + ": ";
  switch (error) {
    case ENOTTY:
    case EISDIR:
      return {what +
                  "not a terminal; name a serial port such as /dev/ttyUSB0, or what `cargobay sim` "
                  "prints",
              code};
    case ENOENT:
    case ENOTDIR:
    case ENXIO:
    case ENODEV:
      return {what +
                  "no such port; plug the cable in, or list what there is with: ls /dev/tty* "
                  "/dev/pts/*",
              code};
    case EACCES:
    case EPERM:
      return {what +
                  "permission denied; join the group that owns it (sudo adduser $USER dialout) and "
                  "log in anew",
              code};
    case EBUSY: return {what + "in use by another process; find it with: fuser -v " + path, code};
    default: return {what + code.message(), code};
  }
}

int PtyTransport::take() {
  // TIOCEXCL does not stop root; the lock does, for all who ask for it.
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) return EBUSY;
  if (tcgetattr(descriptor_, &found_) != 0) return errno;
  found_speed_ = tty_speed(descriptor_);
  ioctl(descriptor_, TIOCEXCL);
  ours_ = true;
  // Raw, 8N1, no flow control, one byte wakes a reader.
  termios settings = found_;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return tcsetattr(descriptor_, TCSANOW, &settings) == 0 ? 0 : errno;
}

// Somebody's own terminal, named by mistake, is one that can be typed on again.
void PtyTransport::give_back() {
  tcsetattr(descriptor_, TCSANOW, &found_);
  // A rate without a constant of its own is not in termios.
  if (found_speed_.has_value() && tty_speed(descriptor_) != found_speed_) {
    (void)set_tty_speed(descriptor_, *found_speed_);  // nobody is left to be told
  }
  ioctl(descriptor_, TIOCNXCL);
}

}  // namespace

Result<std::unique_ptr<ByteStream>> open_pty(const std::string& path, std::uint32_t baud) {
  const int descriptor = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return cannot_open(path, errno);
  auto stream = std::make_unique<PtyTransport>(descriptor, baud);
  if (isatty(descriptor) == 0) return cannot_open(path, ENOTTY);
  if (const int error = stream->take(); error != 0) return cannot_open(path, error);
  if (const std::error_code error = stream->set_baud(baud); error) {
    return Failure{path + " does not run at " + std::to_string(baud) + " baud: " + error.message(),
                   error};
  }
  stream->discard_input();
  return std::unique_ptr<ByteStream>{std::move(stream)};
}

}  // namespace cargobay::hal
