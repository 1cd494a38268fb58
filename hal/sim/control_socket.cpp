#include "hal/sim/control_socket.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "hal/masked_thread.hpp"
#include "hal/sim/control.hpp"
#include "hal/sim/words.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr std::size_t kLongestLine = 1024;
constexpr std::size_t kMostClients = 16;
constexpr int kBacklog = 4;
// A client that does not take its answer is let go of.
constexpr int kPatienceMs = 1000;

std::optional<sockaddr_un> address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return std::nullopt;
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

const sockaddr* generic(const sockaddr_un& address) {
  // The sockets' own way of passing addresses of any kind.
  return reinterpret_cast<const sockaddr*>(&address);
}

Failure failure(const std::string& path, std::error_code code, const std::string& remedy) {
  return {.message = "cannot listen on " + path + ": " + code.message() + "; " + remedy,
          .code = code};
}

// Whether somebody listens there.
bool answers(const sockaddr_un& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool connected = probe >= 0 && connect(probe, generic(address), sizeof address) == 0;
  if (probe >= 0) close(probe);
  return connected;
}

// Clears the place of what a process that is gone left there.
std::error_code make_room(const std::string& path, const sockaddr_un& address) {
  struct stat status{};
  if (lstat(path.c_str(), &status) != 0) return {};
  if (!S_ISSOCK(status.st_mode)) return std::make_error_code(std::errc::file_exists);
  if (answers(address)) return std::make_error_code(std::errc::address_in_use);
  if (unlink(path.c_str()) != 0) return {errno, std::generic_category()};
  return {};
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
    // The line behind the port may be broken too: what follows mends it.
    if (no_more_words(rest) && (name == "replugged" || name == "none")) {
      if (const auto problem = server.replug()) return "error: " + problem->message;
    }
  }
  std::string answer;
  server.with_cable([&](Cable& cable) { answer = control(line, cable); });
  return answer;
}

Result<std::unique_ptr<ControlSocket>> ControlSocket::open(const std::string& path,
                                                           Server& server) {
  const std::optional<sockaddr_un> address = address_of(path);
  if (!address) {
    return failure(path, std::make_error_code(std::errc::filename_too_long),
                   "name a shorter path, under 108 bytes");
  }
  if (const std::error_code error = make_room(path, *address)) {
    return failure(path, error, "name another path, or remove what is there");
  }
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int wake_descriptor = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  const bool listens = listener >= 0 && wake_descriptor >= 0 &&
                       bind(listener, generic(*address), sizeof *address) == 0 &&
                       chmod(path.c_str(), S_IRUSR | S_IWUSR) == 0 &&
                       listen(listener, kBacklog) == 0;
  if (!listens) {
    const std::error_code code{errno, std::generic_category()};
    for (const int descriptor : {listener, wake_descriptor}) {
      if (descriptor >= 0) close(descriptor);
    }
    return failure(path, code, "name a path in a directory you can write to");
  }
  return std::unique_ptr<ControlSocket>{new ControlSocket{path, server, listener, wake_descriptor}};
}

ControlSocket::ControlSocket(std::string path, Server& server, int listener, int wake_descriptor)
    : path_{std::move(path)},
      server_{&server},
      listener_{listener},
      wake_descriptor_{wake_descriptor} {}

ControlSocket::~ControlSocket() {
  stop();
  close(wake_descriptor_);
}

std::error_code ControlSocket::start() {
  return start_masked(thread_, [this] { run(); });
}

void ControlSocket::stop() {
  if (thread_.joinable()) {
    stopping_.store(true, std::memory_order_relaxed);  // the wake-up below orders it
    const std::uint64_t one = 1;
    (void)!::write(wake_descriptor_, &one, sizeof one);  // a full counter wakes as well
    thread_.join();
  }
  if (listener_ < 0) return;
  close(listener_);
  listener_ = -1;
  unlink(path_.c_str());
}

void ControlSocket::run() {
  std::vector<pollfd> sources;
  while (!stopping_.load(std::memory_order_relaxed)) {
    const short hears_newcomers = clients_.size() < kMostClients ? POLLIN : short{0};
    sources = {{.fd = wake_descriptor_, .events = POLLIN, .revents = 0},
               {.fd = listener_, .events = hears_newcomers, .revents = 0}};
    for (const Client& client : clients_) {
      sources.push_back({.fd = client.descriptor, .events = POLLIN, .revents = 0});
    }
    if (poll(sources.data(), sources.size(), -1) < 0) continue;
    for (std::size_t i = clients_.size(); i-- > 0;) {
      if (sources[2 + i].revents == 0 || serve(clients_[i])) continue;
      close(clients_[i].descriptor);
      clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (sources[1].revents != 0) accept_client();
  }
  for (const Client& client : clients_) close(client.descriptor);
  clients_.clear();
}

void ControlSocket::accept_client() {
  const int descriptor = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor >= 0) clients_.push_back({.descriptor = descriptor});
}

bool ControlSocket::serve(Client& client) {
  std::array<char, 4096> bytes{};
  const ssize_t count = recv(client.descriptor, bytes.data(), bytes.size(), 0);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  if (count == 0) return false;
  std::string_view rest{bytes.data(), static_cast<std::size_t>(count)};
  while (!rest.empty()) {
    const std::size_t length = std::min(rest.find('\n'), rest.size());
    const bool whole = length < rest.size();
    if (client.received.size() + length > kLongestLine) client.too_long = true;
    if (!client.too_long) client.received += rest.substr(0, length);
    rest.remove_prefix(whole ? length + 1 : length);
    if (!whole) break;
    const std::string line = std::exchange(client.received, {});
    const bool too_long = std::exchange(client.too_long, false);
    if (!answer(client, too_long ? "error: the line is too long" : control(line, *server_))) {
      return false;
    }
  }
  return true;
}

bool ControlSocket::answer(Client& client, std::string_view line) {
  const std::string text = std::string{line} + "\n";
  std::string_view rest{text};
  while (!rest.empty()) {
    const ssize_t count = send(client.descriptor, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (count >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(count));
      continue;
    }
    if (errno == EINTR) continue;
    pollfd room{.fd = client.descriptor, .events = POLLOUT, .revents = 0};
    if (errno != EAGAIN || poll(&room, 1, kPatienceMs) <= 0) return false;
  }
  return true;
}

}  // namespace cargobay::hal::sim
