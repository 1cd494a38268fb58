#include "hal/jitter/echo_channel.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "hal/jitter/line_slice.hpp"
#include "hal/port/pty_transport.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "hal/sim/line/pty_port.hpp"
#include "oi/commands.hpp"
#include "oi/encode.hpp"

namespace cargobay::hal::jitter {
namespace {

Failure no_line(const char* what) {
  const std::error_code error{errno, std::generic_category()};
  return {std::string{"cannot make "} + what + ": " + error.message(), error};
}

// Answers until the far end has no more to send. Waits as long as the loop would for a late frame:
// the kernel's timer for that is part of what any such program must do.
void echo(int from_source, int to_source, rt::Duration patience, Stamps& stamps,
          const std::atomic<bool>& ended) {
  const auto command = *oi::encode(oi::DriveDirect{.left = {}, .right = {}});
  std::array<std::uint8_t, 256> frame{};
  while (!ended.load(std::memory_order_relaxed)) {
    const timespec timeout = rt::as_timespec(patience);
    pollfd line{.fd = from_source, .events = POLLIN, .revents = 0};
    if (ppoll(&line, 1, &timeout, nullptr) <= 0) continue;
    const std::int64_t woken = rt::nanoseconds(rt::Clock::now());
    if (::read(from_source, frame.data(), frame.size()) <= 0) continue;
    const std::int64_t decided = rt::nanoseconds(rt::Clock::now());
    (void)!::write(to_source, command.data(), command.size());  // 5 bytes into an empty queue
    const std::int64_t written = rt::nanoseconds(rt::Clock::now());
    stamps.woken_ns.store(woken, std::memory_order_relaxed);
    stamps.decided_ns.store(decided, std::memory_order_relaxed);
    stamps.written_ns.store(written, std::memory_order_relaxed);
    // Pairs with the source's load: the stamps before it are this answer's.
    stamps.answers.fetch_add(1, std::memory_order_release);
  }
}

// Owns descriptors; -1 for none.
class Descriptors {
 public:
  Descriptors() = default;
  Descriptors(const Descriptors&) = delete;
  Descriptors& operator=(const Descriptors&) = delete;
  ~Descriptors() {
    for (const int descriptor : all) {
      if (descriptor >= 0) close(descriptor);
    }
  }
  std::array<int, 4> all{-1, -1, -1, -1};
};

class EchoChannel final : public Channel {
 public:
  EchoChannel(std::string name, const Settings& settings, const HeldFrame& held)
      : Channel{std::move(name)}, settings_{settings}, held_{held} {
    measured_.period = settings.period;
  }

  Result<void> make_pty() {
    auto port = sim::PtyPort::open("", kPtyBaud);
    if (!port) return port.failure();
    port_ = std::move(*port);
    auto stream = open_pty(port_->path(), kPtyBaud);
    if (!stream) return stream.failure();
    stream_ = std::move(*stream);
    if (const std::error_code error = stream_->set_wake_threshold(oi::kCreate.frame_bytes); error)
      return Failure{"cannot set the pseudo-terminal: " + error.message(), error};
    source_ = {.to_measured = port_->descriptor(), .from_measured = port_->descriptor()};
    from_source_ = to_source_ = stream_->terminal().descriptor;
    return {};
  }
  Result<void> make_pipes() {
    if (pipe2(&pipes_.all[0], O_CLOEXEC | O_NONBLOCK) != 0) return no_line("a pipe");
    if (pipe2(&pipes_.all[2], O_CLOEXEC | O_NONBLOCK) != 0) return no_line("a pipe");
    source_ = {.to_measured = pipes_.all[1], .from_measured = pipes_.all[2]};
    from_source_ = pipes_.all[0];
    to_source_ = pipes_.all[3];
    return {};
  }

  Result<void> run_slice(const std::atomic<bool>& stop) override {
    Stamps stamps;
    std::atomic<bool> ended{false};
    return run_line_slice(
        source_, settings_, held_, stamps, measured_, grant_,
        [&] { echo(from_source_, to_source_, settings_.period * 4 / 3, stamps, ended); },
        [&] { ended.store(true, std::memory_order_relaxed); }, stop);
  }

 private:
  Settings settings_;
  HeldFrame held_;
  std::unique_ptr<sim::PtyPort> port_;
  std::unique_ptr<ByteStream> stream_;
  Descriptors pipes_;
  Line source_{};
  int from_source_ = -1;
  int to_source_ = -1;
};

}  // namespace

Result<std::unique_ptr<Channel>> make_echo_channel(std::string name, EchoLine line,
                                                   const Settings& settings,
                                                   const HeldFrame& held) {
  auto channel = std::make_unique<EchoChannel>(std::move(name), settings, held);
  const auto made = line == EchoLine::pty ? channel->make_pty() : channel->make_pipes();
  if (!made) return made.failure();
  return std::unique_ptr<Channel>{std::move(channel)};
}

}  // namespace cargobay::hal::jitter
