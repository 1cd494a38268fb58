#include "hal/file/unix_listener.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <optional>
#include <system_error>
#include <utility>

#include "hal/file/left_behind.hpp"

namespace cargobay::hal {

namespace {

constexpr int kBacklog = 16;
constexpr timespec kRetryPause{.tv_sec = 0, .tv_nsec = 5'000'000};

std::optional<sockaddr_un> address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return std::nullopt;
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

const sockaddr* generic(const sockaddr_un& address) {
  // The socket API takes addresses of every kind this way.
  return reinterpret_cast<const sockaddr*>(&address);
}

Failure listen_failure(const std::string& path, std::error_code code, const std::string& remedy) {
  return {.message = "cannot listen on " + path + ": " + code.message() + "; " +
                     remedy_for(code.value(), remedy),
          .code = code};
}

// Connects to the path: 0, or errno.
int try_path(const std::string& path) { return connect_to(path).number() >= 0 ? 0 : errno; }

// Whether the path leads to this listener. If another socket has taken its place, no client can
// reach it.
bool is_reached(int listener, const std::string& path) {
  pollfd newcomer{.fd = listener, .events = POLLIN, .revents = 0};
  return try_path(path) == 0 && poll(&newcomer, 1, 0) > 0;
}

// Why the file at the path must stay; nothing if it is a socket of ours that nothing listens on.
std::error_code reason_to_keep(const std::string& path) {
  struct stat status{};
  if (lstat(path.c_str(), &status) != 0) return {};
  if (!S_ISSOCK(status.st_mode) || status.st_uid != geteuid())
    return std::make_error_code(std::errc::file_exists);
  const int error = try_path(path);
  if (error == ECONNREFUSED) return {};
  if (error == EMFILE || error == ENFILE) return {error, std::generic_category()};
  return std::make_error_code(std::errc::address_in_use);
}

bool is_this_file(const std::string& path, const struct stat& file) {
  struct stat found{};
  return lstat(path.c_str(), &found) == 0 && found.st_dev == file.st_dev &&
         found.st_ino == file.st_ino && found.st_mtim.tv_sec == file.st_mtim.tv_sec &&
         found.st_mtim.tv_nsec == file.st_mtim.tv_nsec;
}

}  // namespace

Descriptor connect_to(const std::string& path) {
  const std::optional<sockaddr_un> address = address_of(path);
  if (!address) {
    errno = ENAMETOOLONG;
    return {};
  }
  Descriptor socket{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (socket.number() < 0) return socket;
  if (connect(socket.number(), generic(*address), sizeof *address) == 0) return socket;
  const int error = errno;
  socket = {};
  errno = error;
  return socket;
}

Result<UnixListener> UnixListener::open(const std::string& path, mode_t rights) {
  Descriptor listener{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (listener.number() < 0)
    return listen_failure(path, {errno, std::generic_category()}, "free some memory");
  UnixListener made{path, std::move(listener)};
  if (const auto bound = made.bind_to_path(rights); !bound) return bound.failure();
  return made;
}

UnixListener::UnixListener(std::string path, Descriptor listener)
    : path_{std::move(path)},
      listener_{std::move(listener)},
      for_children_{PortDescriptor::borrow(listener_.number())} {}

Result<void> UnixListener::bind_to_path(mode_t rights) {
  constexpr int kTries = 10;  // other processes may come and go at that path
  constexpr const char* kTaken = "name another path, or remove what is there";
  const std::optional<sockaddr_un> address = address_of(path_);
  if (!address) {
    return listen_failure(path_, std::make_error_code(std::errc::filename_too_long),
                          "name a path of 1 to 107 bytes");
  }
  const FolderTurn turn{path_};
  const int listener = listener_.number();
  fchmod(listener, rights);  // the file has these rights from the first moment on
  int error = 0;
  for (int i = 0; i < kTries; ++i) {
    if (bind(listener, generic(*address), sizeof *address) == 0) {
      // Until it listens it looks dead: another process may just have removed it.
      const bool ours = ::listen(listener, kBacklog) == 0 && is_reached(listener, path_);
      if (ours && lstat(path_.c_str(), &file_) == 0) return {};
      return listen_failure(path_, std::make_error_code(std::errc::address_in_use), kTaken);
    }
    error = errno;
    if (error != EADDRINUSE) break;
    const std::error_code reason = reason_to_keep(path_);
    // Two processes that want the same dead socket may each have got in the other's way, so look
    // again a little later.
    const bool last = i + 1 == kTries;
    if (reason == std::errc::address_in_use && !last) {
      nanosleep(&kRetryPause, nullptr);
      continue;
    }
    if (reason) return listen_failure(path_, reason, kTaken);
    const std::error_code kept =
        remove_if(path_, [](const std::string& path) { return !reason_to_keep(path); });
    if (kept && kept != std::errc::file_exists) {
      error = kept.value();
      break;
    }
  }
  return listen_failure(
      path_, {error, std::generic_category()},
      error == EADDRINUSE ? kTaken : "name a path in a directory you can write to");
}

Descriptor UnixListener::accept() const {
  return Descriptor{accept4(listener_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)};
}

void UnixListener::close() {
  if (listener_.number() < 0) return;
  for_children_ = PortDescriptor{};
  listener_ = Descriptor{};
  // Leaves alone the socket of another process that has taken the path.
  if (file_.st_ino != 0)
    (void)remove_if(path_, [this](const std::string& path) { return is_this_file(path, file_); });
}

}  // namespace cargobay::hal
