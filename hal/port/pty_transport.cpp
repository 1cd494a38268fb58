#include "hal/port/pty_transport.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>

#include <cerrno>
#include <system_error>

#include "hal/port/port_lock.hpp"
#include "hal/port/tty_speed.hpp"
#include "hal/port/tty_stream.hpp"

namespace cargobay::hal {
namespace {

// The kernel's numbers for the slave sides of pseudo-terminals (Documentation/admin-guide/devices).
constexpr unsigned kFirstPtyMajor = 136;
constexpr unsigned kLastPtyMajor = 143;

class PtyTransport final : public TtyStream {
 public:
  PtyTransport(std::unique_ptr<PortLock> lock, std::uint32_t baud)
      : TtyStream{lock->descriptor(), baud, std::move(lock)} {}

 private:
  std::error_code apply_baud(std::uint32_t baud) override {
    return set_tty_speed(descriptor(), baud);
  }
};

// Raw, 8N1, no flow control, one byte wakes a reader.
std::error_code set_raw(const PortLock& port) {
  termios settings = port.found();
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  if (tcsetattr(port.descriptor(), TCSANOW, &settings) == 0) return {};
  return {errno, std::generic_category()};
}

}  // namespace

bool is_pty(const std::string& path) {
  struct stat file{};
  if (stat(path.c_str(), &file) != 0 || !S_ISCHR(file.st_mode)) return false;
  return major(file.st_rdev) >= kFirstPtyMajor && major(file.st_rdev) <= kLastPtyMajor;
}

Result<std::unique_ptr<ByteStream>> open_pty(const std::string& path, std::uint32_t baud) {
  auto lock = PortLock::take(path);
  if (!lock) return lock.failure();
  if (const std::error_code error = set_raw(**lock)) return cannot_open(path, error);
  auto stream = std::make_unique<PtyTransport>(std::move(*lock), baud);
  if (const std::error_code error = stream->set_baud(baud); error) {
    return Failure{path + " does not run at " + std::to_string(baud) + " baud: " + error.message(),
                   error};
  }
  stream->discard_input();
  return std::unique_ptr<ByteStream>{std::move(stream)};
}

}  // namespace cargobay::hal
