#include "hal/sim/line/virtual_link.hpp"

#include <algorithm>
#include <cerrno>

// The robot on the far side is not part of the real-time path, although it runs in this link's
// calls: it allocates nothing once built, which RealtimeSanitizer checks, but its functions are not
// marked one by one.
#if defined(__clang__) && __clang_major__ >= 20
#pragma clang diagnostic ignored "-Wfunction-effects"
#endif

namespace cargobay::hal::sim {

ByteStream::Wait VirtualLink::wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING {
  const rt::Duration until = deadline.time_since_epoch();
  for (;;) {
    if (hung_up_) return Wait::hung_up;
    if (cable_.available() >= wake_threshold_) return Wait::ready;
    if (cable_.now() >= until) return Wait::timed_out;
    cable_.advance_to(std::min(cable_.next_event(), until));
  }
}

ByteStream::Transfer VirtualLink::read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  const std::size_t count = cable_.take(bytes);
  return {.count = count, .error = count == 0 && hung_up_ ? EIO : 0};
}

ByteStream::Transfer VirtualLink::write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  if (hung_up_) return {.count = 0, .error = EIO};
  return {.count = cable_.send(bytes), .error = 0};
}

rt::TimePoint VirtualLink::now() const CARGOBAY_NONBLOCKING { return rt::TimePoint{cable_.now()}; }

std::error_code VirtualLink::set_baud(std::uint32_t baud) {
  if (baud == 0) return std::make_error_code(std::errc::invalid_argument);
  cable_.set_host_baud(baud);
  return {};
}

std::error_code VirtualLink::set_wake_threshold(std::size_t bytes) {
  if (bytes < 1 || bytes > 255) return std::make_error_code(std::errc::invalid_argument);
  wake_threshold_ = bytes;
  return {};
}

bool VirtualLink::drain(rt::Duration timeout) {
  const rt::Duration deadline = cable_.now() + timeout;
  const bool in_time = cable_.sent_at() <= deadline;
  const rt::Duration until = std::min(cable_.sent_at(), deadline);
  if (until > cable_.now()) cable_.advance_to(until);
  return in_time;
}

}  // namespace cargobay::hal::sim
