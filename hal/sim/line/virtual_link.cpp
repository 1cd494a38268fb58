#include "hal/sim/line/virtual_link.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "rt/unchecked.hpp"

// The robot on the far side is not part of the real-time path, although it runs in this link's
// calls: it allocates nothing once built, which RealtimeSanitizer checks, but its functions are not
// marked one by one.
#if defined(__clang__) && __clang_major__ >= 20
#pragma clang diagnostic ignored "-Wfunction-effects"
#endif

namespace cargobay::hal::sim {

void VirtualTime::join(VirtualLink& link) {
  link.cable().advance_to(now_);
  links_.push_back(&link);
}

void VirtualTime::leave(VirtualLink& link) { std::erase(links_, &link); }

void VirtualTime::step(const VirtualLink* waiting, rt::Duration until) {
  // What is still to do at this instant: a pass that has not begun to wait, or one that comes after
  // that of the link that was waited on.
  for (VirtualLink* const link : links_) {
    if (link != waiting) link->make_passes();
  }
  rt::Duration next = until;
  for (const VirtualLink* const link : links_) next = std::min(next, link->next_event());
  now_ = std::max(now_, next);
  for (VirtualLink* const link : links_) link->cable().advance_to(now_);
  for (VirtualLink* const link : links_) {
    if (link == waiting) return;
    link->make_passes();
  }
}

void VirtualTime::advance_to(rt::Duration until) {
  do {
    step(nullptr, until);
  } while (now_ < until);
}

VirtualLink::VirtualLink(Device& device, VirtualTime& time) : cable_{device}, time_{&time} {
  time.join(*this);
}

VirtualLink::~VirtualLink() {
  if (time_ != nullptr) time_->leave(*this);
}

void VirtualLink::set_pass(std::function<void()> pass) {
  pass_ = std::move(pass);
  left_ = false;
}

rt::Duration VirtualLink::next_event() const {
  const rt::Duration next = cable_.next_event();
  return left_ ? std::min(next, waits_until_) : next;
}

void VirtualLink::make_passes() {
  if (!pass_ || (left_ && !over())) return;
  making_pass_ = true;
  do {
    left_ = false;
    passed_ = false;
    // What the loop does besides waiting and sending is checked where it runs by itself.
    rt::unchecked([this] { pass_(); });
  } while (passed_ && !left_);
  making_pass_ = false;
}

std::optional<ByteStream::Wait> VirtualLink::over() const {
  if (hung_up_) return Wait::hung_up;
  if (cable_.available() >= wake_threshold_) return Wait::ready;
  if (cable_.now() >= waits_until_) return Wait::timed_out;
  return std::nullopt;
}

ByteStream::Wait VirtualLink::wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING {
  waits_until_ = deadline.time_since_epoch();
  passed_ = true;
  left_ = false;
  for (;;) {
    if (const std::optional<Wait> how = over()) return *how;
    if (making_pass_) {
      left_ = true;
      return Wait::left;
    }
    move_on(waits_until_);
  }
}

void VirtualLink::move_on(rt::Duration until) {
  if (time_ != nullptr) {
    time_->step(this, until);
  } else {
    cable_.advance_to(std::min(cable_.next_event(), until));
  }
}

void VirtualLink::advance(rt::Duration period) {
  const rt::Duration until = cable_.now() + period;
  do {
    move_on(until);
  } while (cable_.now() < until);
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

std::error_code VirtualLink::set_modem_line(ModemLine line, bool asserted) {
  if (!modem_line_) return ByteStream::set_modem_line(line, asserted);
  modem_line_(line, asserted);
  return {};
}

bool VirtualLink::drain(rt::Duration timeout) {
  const rt::Duration deadline = cable_.now() + timeout;
  const bool in_time = cable_.sent_at() <= deadline;
  const rt::Duration until = std::min(cable_.sent_at(), deadline);
  if (until > cable_.now()) advance(until - cable_.now());
  return in_time;
}

}  // namespace cargobay::hal::sim
