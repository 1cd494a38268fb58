#include "hal/guard/stop_robot.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <span>

#include "hal/guard_block.hpp"
#include "hal/tty_speed.hpp"
#include "oi/baud.hpp"
#include "oi/encode.hpp"
#include "oi/fixed_list.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_budget.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr int kTries = 3;
constexpr milliseconds kWriteTimeout{200};
constexpr milliseconds kModeChangeWait{50};  // as leave() waits
constexpr milliseconds kAnswerTimeout{100};
// Completes any command: a count, and as many bytes as it can say.
constexpr std::uint32_t kAnyCommand = 256;

using Bytes = oi::FixedList<std::uint8_t, 300>;

template <typename Command>
void append(Bytes& bytes, const Command& command) {
  if (const auto encoded = oi::encode(command)) (void)bytes.append(*encoded);  // room for all
}

bool wait_for(int descriptor, short events, rt::TimePoint limit) {
  const auto left = std::chrono::ceil<milliseconds>(limit - rt::Clock::now());
  pollfd port{.fd = descriptor, .events = events, .revents = 0};
  const int ready = poll(&port, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
  return ready == 1 && (port.revents & events) != 0;
}

bool write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  const rt::TimePoint limit = rt::Clock::now() + kWriteTimeout;
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    if (count < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (!bytes.empty() && !wait_for(descriptor, POLLOUT, limit)) return false;
  }
  return true;
}

// 0 is harmless as data, where it stands for no speed, and as an opcode, which no robot knows.
Bytes farewell(std::uint32_t fill) {
  Bytes bytes;
  for (std::uint32_t i = 0; i < std::min(fill, kAnyCommand); ++i) (void)bytes.push_back(0);
  append(bytes, oi::DriveDirect{});  // while it still obeys
  append(bytes, oi::PauseResumeStream{oi::StreamState::pause});
  append(bytes, oi::Start{});  // Passive
  return bytes;
}

// `behind`: so many bytes that are on their way before.
bool says_passive(int descriptor, std::size_t behind) {
  const auto on_the_wire = oi::wire_time(behind, tty_speed(descriptor).value_or(oi::kBrcBaud));
  const auto pause = std::chrono::ceil<milliseconds>(on_the_wire + kModeChangeWait);
  poll(nullptr, 0, static_cast<int>(pause.count()));
  tcflush(descriptor, TCIFLUSH);
  Bytes question;
  append(question, oi::Sensors{oi::PacketId::oi_mode});
  if (!write_all(descriptor, question)) return false;
  if (!wait_for(descriptor, POLLIN, rt::Clock::now() + kAnswerTimeout)) return false;
  std::uint8_t mode = 0xff;
  if (read(descriptor, &mode, 1) != 1) return false;
  return mode == static_cast<std::uint8_t>(oi::Mode::passive) ||
         mode == static_cast<std::uint8_t>(oi::Mode::off);
}

// One byte wakes a reader: the dead one may have waited for whole frames.
void wake_by_byte(int descriptor) {
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0 || settings.c_cc[VMIN] == 1) return;
  settings.c_cc[VMIN] = 1;
  tcsetattr(descriptor, TCSANOW, &settings);
}

}  // namespace

bool stop_robot(int descriptor, std::uint32_t in_writing) {
  std::uint32_t fill = in_writing;
  int waiting = 0;
  if (ioctl(descriptor, TIOCOUTQ, &waiting) == 0 && waiting > kMostBacklog) {
    tcflush(descriptor, TCOFLUSH);
    fill = kAnyCommand;  // one of them was cut
  }
  for (int i = 0; i < kTries; ++i) {
    const Bytes bytes = farewell(fill);
    if (!write_all(descriptor, bytes)) return false;
    if (i == 0) wake_by_byte(descriptor);
    if (says_passive(descriptor, bytes.size())) return true;
    fill = kAnyCommand;  // something on the way went wrong
  }
  return false;
}

}  // namespace cargobay::hal
