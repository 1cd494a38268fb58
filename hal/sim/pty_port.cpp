#include "hal/sim/pty_port.hpp"

#include <fcntl.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "hal/tty_speed.hpp"

namespace cargobay::hal::sim {

namespace {

Failure failure(const std::string& what, int error, const std::string& remedy) {
  const std::error_code code{error, std::generic_category()};
  return {.message = what + ": " + code.message() + "; " + remedy, .code = code};
}

std::error_code last_error() { return {errno, std::generic_category()}; }

// A fresh pseudo-terminal echoes and waits for whole lines.
std::error_code make_raw(int slave, std::uint32_t baud) {
  struct termios settings{};
  if (tcgetattr(slave, &settings) != 0) return last_error();
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  if (tcsetattr(slave, TCSANOW, &settings) != 0) return last_error();
  return set_tty_speed(slave, baud);
}

std::string link_target(const std::string& link) {
  std::array<char, 4096> target{};
  const ssize_t length = readlink(link.c_str(), target.data(), target.size());
  return length < 0 ? std::string{} : std::string{target.data(), static_cast<std::size_t>(length)};
}

std::error_code make_link(const std::string& target, const std::string& link) {
  struct stat status{};
  if (lstat(link.c_str(), &status) == 0) {
    if (!S_ISLNK(status.st_mode)) return std::make_error_code(std::errc::file_exists);
    if (unlink(link.c_str()) != 0) return last_error();
  }
  if (symlink(target.c_str(), link.c_str()) != 0) return last_error();
  return {};
}

}  // namespace

Result<std::unique_ptr<PtyPort>> PtyPort::open(const std::string& link, std::uint32_t baud) {
  std::unique_ptr<PtyPort> port{new PtyPort};
  port->host_baud_ = baud;
  port->master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (port->master_ < 0 || grantpt(port->master_) != 0 || unlockpt(port->master_) != 0) {
    return failure("no pseudo-terminal for the virtual Create", errno,
                   "is devpts mounted on /dev/pts, and /dev/ptmx there?");
  }
  std::array<char, 64> path{};
  if (ptsname_r(port->master_, path.data(), path.size()) != 0) {
    return failure("no name for the virtual Create's pseudo-terminal", errno,
                   "is devpts mounted on /dev/pts?");
  }
  port->device_path_ = path.data();
  port->slave_ = ::open(path.data(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (port->slave_ < 0) {
    return failure("cannot open " + port->device_path_, errno, "is devpts mounted on /dev/pts?");
  }
  if (const std::error_code error = make_raw(port->slave_, baud)) {
    return failure("cannot set " + port->device_path_ + " to " + std::to_string(baud) + " baud",
                   error.value(), "choose one of the robot's rates");
  }
  // Without it, as where the user's watches are used up, somebody is taken to be there always.
  port->watch_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (port->watch_ >= 0 && inotify_add_watch(port->watch_, path.data(), IN_OPEN | IN_CLOSE) < 0) {
    close(port->watch_);
    port->watch_ = -1;
  }
  if (link.empty()) return port;
  if (const std::error_code error = make_link(port->device_path_, link)) {
    const bool taken = error == std::errc::file_exists;
    return failure("cannot make the link " + link, error.value(),
                   taken ? "it is no symbolic link: remove it or name another"
                         : "name a path in a directory you can write to");
  }
  port->link_ = link;
  return port;
}

PtyPort::~PtyPort() {
  if (!link_.empty() && link_target(link_) == device_path_) unlink(link_.c_str());
  for (const int descriptor : {watch_, slave_, master_}) {
    if (descriptor >= 0) close(descriptor);
  }
}

void PtyPort::update_clients() {
  if (watch_ < 0) return;
  alignas(inotify_event) std::array<char, 4096> events{};
  const int before = clients_;
  for (;;) {
    const ssize_t length = ::read(watch_, events.data(), events.size());
    if (length <= 0) break;
    for (std::size_t at = 0; at + sizeof(inotify_event) <= static_cast<std::size_t>(length);) {
      inotify_event event{};
      std::memcpy(&event, events.data() + at, sizeof event);
      if ((event.mask & IN_OPEN) != 0) ++clients_;
      if ((event.mask & IN_CLOSE) != 0) clients_ = std::max(clients_ - 1, 0);
      at += sizeof event + event.len;
    }
  }
  if (before > 0 && clients_ == 0) last_client_gone();
}

void PtyPort::last_client_gone() {
  ioctl(slave_, TIOCNXCL);
  tcflush(slave_, TCIFLUSH);
}

std::size_t PtyPort::read(std::span<std::uint8_t> bytes) {
  const ssize_t count = ::read(master_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t PtyPort::write(std::span<const std::uint8_t> bytes) {
  const ssize_t count = ::write(master_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::uint32_t PtyPort::host_baud() {
  const std::uint32_t baud = tty_speed(master_).value_or(0);
  if (baud != 0) host_baud_ = baud;
  return host_baud_;
}

}  // namespace cargobay::hal::sim
