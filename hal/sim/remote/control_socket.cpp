#include "hal/sim/remote/control_socket.hpp"

#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <optional>
#include <utility>

#include "hal/machine/masked_thread.hpp"
#include "hal/sim/line/left_behind.hpp"
#include "hal/sim/next_word.hpp"
#include "hal/sim/remote/control.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr std::size_t kMostClients = 16;
constexpr int kBacklog = 16;
constexpr timespec kRetryPause{.tv_sec = 0, .tv_nsec = 5'000'000};
// How long to accept no client after the system refused to: it would refuse again at once.
constexpr rt::Duration kRefusalPause = std::chrono::milliseconds{100};

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

Failure failure(const std::string& path, std::error_code code, const std::string& remedy) {
  return {.message = "cannot listen on " + path + ": " + code.message() + "; " +
                     remedy_for(code.value(), remedy),
          .code = code};
}

// Connects to the path: 0, or errno. Never waits: a socket with a full queue returns EAGAIN.
int try_path(const sockaddr_un& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool connected = probe >= 0 && connect(probe, generic(address), sizeof address) == 0;
  const int error = connected ? 0 : errno;
  if (probe >= 0) close(probe);
  return error;
}

// Whether the path leads to this listener. If another socket has taken its place, no client can
// reach it.
bool is_reached(int listener, const sockaddr_un& address) {
  pollfd newcomer{.fd = listener, .events = POLLIN, .revents = 0};
  return try_path(address) == 0 && poll(&newcomer, 1, 0) > 0;
}

// Why the file at the path must stay; nothing if it is a socket of ours that nothing listens on.
std::error_code reason_to_keep(const std::string& path, const sockaddr_un& address) {
  struct stat status{};
  if (lstat(path.c_str(), &status) != 0) return {};
  if (!S_ISSOCK(status.st_mode) || status.st_uid != geteuid())
    return std::make_error_code(std::errc::file_exists);
  const int error = try_path(address);
  if (error == ECONNREFUSED) return {};
  if (error == EMFILE || error == ENFILE) return {error, std::generic_category()};
  return std::make_error_code(std::errc::address_in_use);
}

bool same_file(const std::string& path, const struct stat& file) {
  struct stat found{};
  return lstat(path.c_str(), &found) == 0 && found.st_dev == file.st_dev &&
         found.st_ino == file.st_ino && found.st_mtim.tv_sec == file.st_mtim.tv_sec &&
         found.st_mtim.tv_nsec == file.st_mtim.tv_nsec;
}

}  // namespace

std::string control(std::string_view line, Server& server) {
  std::string_view rest = line;
  if (next_word(rest) == "fault") {
    const std::string_view name = next_word(rest);
    if (no_more_words(rest) && name == "unplugged") {
      server.unplug();
      return "ok";
    }
    // The line beyond the port may have faults too; the code below clears them.
    if (no_more_words(rest) && (name == "replugged" || name == "none")) {
      if (const auto done = server.replug(); !done) return "error: " + done.failure().message;
    }
  }
  std::string answer;
  server.with_cable([&](Cable& cable) { answer = control(line, cable); });
  return answer;
}

Result<std::unique_ptr<ControlSocket>> ControlSocket::open(const std::string& path,
                                                           Server& server) {
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int wake_descriptor = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  const std::error_code code{errno, std::generic_category()};
  std::unique_ptr<ControlSocket> control{
      new ControlSocket{path, server, listener, wake_descriptor}};
  if (listener < 0 || wake_descriptor < 0) return failure(path, code, "free some memory");
  if (const auto listens = control->listen_on_path(); !listens) return listens.failure();
  return control;
}

Result<void> ControlSocket::listen_on_path() {
  constexpr int kTries = 10;  // other processes may come and go at that path
  constexpr const char* kTaken = "name another path, or remove what is there";
  const std::optional<sockaddr_un> address = address_of(path_);
  if (!address) {
    return failure(path_, std::make_error_code(std::errc::filename_too_long),
                   "name a path of 1 to 107 bytes");
  }
  const FolderTurn turn{path_};
  fchmod(listener_, S_IRUSR | S_IWUSR);  // the file has these rights from the first moment on
  int error = 0;
  for (int i = 0; i < kTries; ++i) {
    if (bind(listener_, generic(*address), sizeof *address) == 0) {
      // Until it listens it looks dead: another process may just have removed it.
      const bool ours = listen(listener_, kBacklog) == 0 && is_reached(listener_, *address);
      if (ours && lstat(path_.c_str(), &file_) == 0) return {};
      return failure(path_, std::make_error_code(std::errc::address_in_use), kTaken);
    }
    error = errno;
    if (error != EADDRINUSE) break;
    const std::error_code reason = reason_to_keep(path_, *address);
    // Two processes that want the same dead socket may each have got in the other's way, so look
    // again a little later.
    const bool last = i + 1 == kTries;
    if (reason == std::errc::address_in_use && !last) {
      nanosleep(&kRetryPause, nullptr);
      continue;
    }
    if (reason) return failure(path_, reason, kTaken);
    const std::error_code kept = remove_if(path_, [](const std::string& path) {
      const std::optional<sockaddr_un> there = address_of(path);
      return there && !reason_to_keep(path, *there);
    });
    if (kept && kept != std::errc::file_exists) {
      error = kept.value();
      break;
    }
  }
  return failure(path_, {error, std::generic_category()},
                 error == EADDRINUSE ? kTaken : "name a path in a directory you can write to");
}

ControlSocket::ControlSocket(std::string path, Server& server, int listener, int wake_descriptor)
    : path_{std::move(path)},
      server_{&server},
      listener_{listener},
      wake_descriptor_{wake_descriptor} {}

ControlSocket::~ControlSocket() {
  stop();
  for (const int descriptor : {listener_, wake_descriptor_}) {
    if (descriptor >= 0) close(descriptor);
  }
}

std::error_code ControlSocket::start() {
  return start_masked(thread_, [this] { run(); });
}

void ControlSocket::stop() {
  if (thread_.joinable()) {
    stopping_.store(true, std::memory_order_relaxed);  // the wake-up below orders it
    const std::uint64_t one = 1;
    (void)!::write(wake_descriptor_, &one, sizeof one);  // even if the counter is full, this wakes
    thread_.join();
  }
  if (listener_ < 0) return;
  close(listener_);
  listener_ = -1;
  // Leaves alone the socket of another process that has taken the path.
  (void)remove_if(path_, [this](const std::string& path) { return same_file(path, file_); });
}

void ControlSocket::run() {
  const ControlConnection::Answers answers = [this](std::string_view line) {
    return control(line, *server_);
  };
  std::vector<pollfd> sources;
  while (!stopping_.load(std::memory_order_relaxed)) {
    wait(sources);
    const rt::TimePoint now = rt::Clock::now();
    for (std::size_t i = clients_.size(); i-- > 0;) {
      const auto deadline = clients_[i].deadline();
      const bool due = sources[2 + i].revents != 0 || (deadline && *deadline <= now);
      if (!due || clients_[i].serve(now, answers)) continue;
      clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
      accept_again_ = now;  // its descriptor is free now
    }
    if (sources[1].revents != 0) accept_client();
  }
  clients_.clear();
}

void ControlSocket::wait(std::vector<pollfd>& sources) const {
  const rt::TimePoint now = rt::Clock::now();
  const bool paused = now < accept_again_;
  rt::TimePoint until = paused ? accept_again_ : rt::TimePoint::max();
  sources = {{.fd = wake_descriptor_, .events = POLLIN, .revents = 0},
             {.fd = paused ? -1 : listener_, .events = POLLIN, .revents = 0}};
  for (const ControlConnection& client : clients_) {
    sources.push_back({.fd = client.descriptor(), .events = client.events(), .revents = 0});
    if (client.deadline()) until = std::min(until, *client.deadline());
  }
  const timespec timeout = rt::as_timespec(std::max(until - now, rt::Duration::zero()));
  const bool forever = until == rt::TimePoint::max();
  if (ppoll(sources.data(), sources.size(), forever ? nullptr : &timeout, nullptr) >= 0) return;
  if (errno == EINTR) return;
  // ppoll refuses this many descriptors, as above a lowered limit of open files: serve every client
  // now and then instead.
  const timespec pause = rt::as_timespec(kRefusalPause);
  nanosleep(&pause, nullptr);
  for (pollfd& source : sources) source.revents = source.events;
}

void ControlSocket::accept_client() {
  const int descriptor = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor < 0) {
    const bool retry = errno == EAGAIN || errno == EINTR || errno == ECONNABORTED;
    if (!retry) accept_again_ = rt::Clock::now() + kRefusalPause;
    return;
  }
  ControlConnection client{descriptor};
  if (clients_.size() < kMostClients) {
    clients_.push_back(std::move(client));
  } else {
    client.dismiss("error: " + std::to_string(kMostClients) +
                   " clients are connected, which is the most; disconnect one");
  }
}

}  // namespace cargobay::hal::sim
