// A client of a serial port like any program: open, raw, a rate, read and write.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/port/tty_speed.hpp"

namespace cargobay::hal::sim::test {

using Bytes = std::vector<std::uint8_t>;

// For waits for things that are sure to happen; a test that has to wait this long fails.
inline constexpr std::chrono::seconds kPatience{10};

template <typename Condition>
bool eventually(Condition&& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 1);
  }
  return true;
}

class SerialClient {
 public:
  explicit SerialClient(const std::string& path, std::uint32_t baud = 57600)
      : descriptor_{open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)} {
    struct termios settings{};
    tcgetattr(descriptor_, &settings);
    cfmakeraw(&settings);
    tcsetattr(descriptor_, TCSANOW, &settings);
    set_baud(baud);
  }
  ~SerialClient() { close(descriptor_); }
  SerialClient(const SerialClient&) = delete;
  SerialClient& operator=(const SerialClient&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  bool set_baud(std::uint32_t baud) const { return !set_tty_speed(descriptor_, baud); }

  // Sends all of them, waiting for room if there is none.
  bool send(const Bytes& bytes) const {
    std::span<const std::uint8_t> left{bytes};
    while (!left.empty()) {
      const ssize_t count = write(descriptor_, left.data(), left.size());
      if (count > 0) {
        left = left.subspan(static_cast<std::size_t>(count));
      } else if (!ready(POLLOUT)) {
        return false;
      }
    }
    return true;
  }
  // `count` bytes, or those that came before patience ran out.
  Bytes receive(std::size_t count) const {
    Bytes bytes;
    while (bytes.size() < count && ready(POLLIN)) {
      Bytes chunk(count - bytes.size());
      const ssize_t got = read(descriptor_, chunk.data(), chunk.size());
      if (got > 0) bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + got);
    }
    return bytes;
  }
  Bytes ask(const Bytes& command, std::size_t answer_bytes) const {
    return send(command) ? receive(answer_bytes) : Bytes{};
  }
  // Whether something can be read now.
  bool has_input() const {
    pollfd port{.fd = descriptor_, .events = POLLIN, .revents = 0};
    return poll(&port, 1, 0) > 0;
  }

 private:
  bool ready(short events) const {
    pollfd port{.fd = descriptor_, .events = events, .revents = 0};
    return poll(&port, 1, static_cast<int>(std::chrono::milliseconds{kPatience}.count())) > 0;
  }

  int descriptor_;
};

}  // namespace cargobay::hal::sim::test
