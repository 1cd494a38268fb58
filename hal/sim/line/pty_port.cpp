#include "hal/sim/line/pty_port.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "hal/file/left_behind.hpp"
#include "hal/port/tty_speed.hpp"

namespace cargobay::hal::sim {

namespace {

Failure failure(const std::string& what, int error, const std::string& remedy) {
  const std::error_code code{error, std::generic_category()};
  return {.message = what + ": " + code.message() + "; " + remedy_for(error, remedy), .code = code};
}

std::error_code last_error() { return {errno, std::generic_category()}; }

// A new pseudo-terminal echoes and waits for whole lines.
std::error_code make_raw(int slave, std::uint32_t baud) {
  struct termios settings{};
  if (tcgetattr(slave, &settings) != 0) return last_error();
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  if (tcsetattr(slave, TCSANOW, &settings) != 0) return last_error();
  return set_tty_speed(slave, baud);
}

// Whether a virtual Create of ours may have made a link to this path.
bool is_pty_path(std::string_view path) {
  constexpr std::string_view kFolder = "/dev/pts/";
  if (!path.starts_with(kFolder)) return false;
  path.remove_prefix(kFolder.size());
  return !path.empty() && path.find_first_not_of("0123456789") == std::string_view::npos;
}

bool before(const timespec& one, const timespec& other) {
  return one.tv_sec != other.tv_sec ? one.tv_sec < other.tv_sec : one.tv_nsec < other.tv_nsec;
}

// Whether the pseudo-terminal for which the link was made is gone. The next one to be opened gets
// its name: the link then leads to a terminal that is younger than itself. (The kernel keeps no
// time of birth for a terminal, but that of the last change of owner or rights.)
bool outlives(const struct stat& link, const std::string& target) {
  struct stat terminal{};
  return lstat(target.c_str(), &terminal) != 0 || before(link.st_mtim, terminal.st_ctim);
}

// Why the file at the link's path must stay, and what to do; nothing if it is a link that a dead
// virtual Create left behind. A link to `ours`, the new pseudo-terminal, is one of those.
std::optional<std::string> reason_to_keep(const std::string& link, const std::string& ours) {
  constexpr const char* kRemedy = ": remove it or name another";
  struct stat status{};
  if (lstat(link.c_str(), &status) != 0) return std::nullopt;
  if (!S_ISLNK(status.st_mode)) return std::string{"it is not a symbolic link"} + kRemedy;
  const std::string target = link_target(link);
  if (!is_pty_path(target))
    return "it points to " + target + ", which is not a virtual Create" + kRemedy;
  if (status.st_uid != geteuid()) return std::string{"it is another user's"} + kRemedy;
  if (target == ours || outlives(status, target)) return std::nullopt;
  return "it points to " + target +
         ", which is in use: end the `cargobay sim` that serves it, or name another link (if it is "
         "another program's, remove the link)";
}

}  // namespace

Result<void> PtyPort::make_link(const std::string& link) {
  constexpr int kTries = 10;  // other processes may come and go at that path
  const FolderTurn turn{link};
  int error = 0;
  for (int i = 0; i < kTries; ++i) {
    if (symlink(device_path_.c_str(), link.c_str()) == 0) {
      link_ = link;
      return {};
    }
    error = errno;
    if (error != EEXIST) break;
    if (const auto reason = reason_to_keep(link, device_path_))
      return failure("cannot make the link " + link, error, *reason);
    const std::error_code kept = remove_if(link, [this](const std::string& path) {
      return !reason_to_keep(path, device_path_).has_value();
    });
    if (kept && kept != std::errc::file_exists) {
      error = kept.value();
      break;
    }
  }
  return failure("cannot make the link " + link, error,
                 "name a path in a directory you can write to");
}

Result<std::unique_ptr<PtyPort>> PtyPort::open(const std::string& link, std::uint32_t baud) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (master < 0) {
    return failure("no pseudo-terminal for the virtual Create", errno,
                   "is devpts mounted on /dev/pts, and /dev/ptmx there?");
  }
  std::array<char, 64> path{};
  const bool named = grantpt(master) == 0 && unlockpt(master) == 0 &&
                     ptsname_r(master, path.data(), path.size()) == 0;
  const int unnamed = errno;
  std::unique_ptr<PtyPort> port{new PtyPort{master, path.data(), baud}};
  if (!named) {
    return failure("no name for the virtual Create's pseudo-terminal", unnamed,
                   "is devpts mounted on /dev/pts?");
  }
  if (const std::error_code error = port->clients_.open())
    return failure("cannot open " + port->device_path_, error.value(),
                   "is devpts mounted on /dev/pts?");
  if (const std::error_code error = make_raw(port->clients_.own(), baud)) {
    return failure("cannot set " + port->device_path_ + " to " + std::to_string(baud) + " baud",
                   error.value(), "choose one of the robot's rates");
  }
  if (!link.empty()) {
    if (const auto linked = port->make_link(link); !linked) return linked.failure();
  }
  return port;
}

PtyPort::~PtyPort() {
  if (!link_.empty()) {
    // Leaves alone the link of another process that has taken the path.
    (void)remove_if(link_,
                    [this](const std::string& path) { return link_target(path) == device_path_; });
  }
  if (master_ >= 0) close(master_);
}

bool PtyPort::intact() const {
  unsigned number = 0;
  return ioctl(master_, TIOCGPTN, &number) == 0 &&
         device_path_.ends_with("/" + std::to_string(number));
}

void PtyPort::disown() {
  clients_.disown();
  master_ = -1;
}

std::size_t PtyPort::read(std::span<std::uint8_t> bytes, rt::TimePoint now) {
  const ssize_t count = ::read(master_, bytes.data(), bytes.size());
  if (count <= 0) return 0;
  clients_.heard(now);
  return static_cast<std::size_t>(count);
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
