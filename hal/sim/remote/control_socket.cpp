#include "hal/sim/remote/control_socket.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <utility>

#include "hal/file/left_behind.hpp"
#include "hal/machine/masked_thread.hpp"
#include "hal/sim/next_word.hpp"
#include "hal/sim/remote/control.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr std::size_t kMostClients = 16;
// How long to accept no client after the system refused to: it would refuse again at once.
constexpr rt::Duration kRefusalPause = std::chrono::milliseconds{100};

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
  Descriptor wake{eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)};
  if (wake.number() < 0) {
    const std::error_code code{errno, std::generic_category()};
    return Failure{.message = "cannot listen on " + path + ": " + code.message() + "; " +
                              remedy_for(code.value(), "free some memory"),
                   .code = code};
  }
  auto listener = UnixListener::open(path, S_IRUSR | S_IWUSR);
  if (!listener) return listener.failure();
  return std::unique_ptr<ControlSocket>{
      new ControlSocket{server, std::move(*listener), std::move(wake)}};
}

ControlSocket::ControlSocket(Server& server, UnixListener listener, Descriptor wake)
    : server_{&server}, listener_{std::move(listener)}, wake_{std::move(wake)} {}

ControlSocket::~ControlSocket() { stop(); }

std::error_code ControlSocket::start() {
  return start_masked(thread_, [this] { run(); });
}

void ControlSocket::stop() {
  if (thread_.joinable()) {
    stopping_.store(true, std::memory_order_relaxed);  // the wake-up below orders it
    const std::uint64_t one = 1;
    (void)!::write(wake_.number(), &one, sizeof one);  // even if the counter is full, this wakes
    thread_.join();
  }
  listener_.close();
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
  sources = {{.fd = wake_.number(), .events = POLLIN, .revents = 0},
             {.fd = paused ? -1 : listener_.descriptor(), .events = POLLIN, .revents = 0}};
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
  Descriptor accepted = listener_.accept();
  if (accepted.number() < 0) {
    const bool retry = errno == EAGAIN || errno == EINTR || errno == ECONNABORTED;
    if (!retry) accept_again_ = rt::Clock::now() + kRefusalPause;
    return;
  }
  ControlConnection client{std::move(accepted)};
  if (clients_.size() < kMostClients) {
    clients_.push_back(std::move(client));
  } else {
    client.dismiss("error: " + std::to_string(kMostClients) +
                   " clients are connected, which is the most; disconnect one");
  }
}

}  // namespace cargobay::hal::sim
