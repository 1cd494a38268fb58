// What other threads ask for: taken up at the beginning of a frame, sent behind the loop's
// commands.
#include <algorithm>

#include "hal/cycle/control_cycle.hpp"

namespace cargobay::hal {

// What needs no room on the line is done at once; a command waits for its own frame, and what was
// asked for behind it waits with it.
void ControlCycle::take_requests() noexcept CARGOBAY_NONBLOCKING {
  if (requests_.empty()) return;  // which is cheaper to ask than a request to make
  Request request;
  for (std::size_t i = 0; i < kMostRequests && !command_ && requests_.pop(request); ++i) {
    if (observer_.request != nullptr) observer_.request(observer_.context, request);
    take(request);
  }
}

void ControlCycle::take(const Request& request) noexcept CARGOBAY_NONBLOCKING {
  switch (request.kind) {
    case Request::Kind::command: command_ = request; break;
    case Request::Kind::stream: rotation_.stream(request.extras); break;
    case Request::Kind::look: rotation_.look_at(request.extras); break;
    case Request::Kind::pose: odometry_.reset(request.pose); break;
  }
}

// Where the robot hears, its mode allows it, and there is room: one command a frame.
void ControlCycle::add_command() noexcept CARGOBAY_NONBLOCKING {
  if (!command_) return;
  const std::span<const std::uint8_t> bytes = command_->command();
  const oi::CommandInfo* info = bytes.empty() ? nullptr : oi::find_command(bytes[0]);
  if (info == nullptr || !info->available_in(mode_watch_.mode())) {
    command_.reset();  // the mode was lost since it was asked for
    return;
  }
  const rt::TimePoint now = stream_.now();
  if (!hears() || line_free_ > now) return;
  const bool stands = acting_ == rt::WheelSpeeds{} && loop_.set() == rt::WheelSpeeds{};
  const bool is_long = bytes.size() > spare_bytes_;
  if (is_long && !stands && command_->when_long == Request::WhenLong::wait) return;
  outgoing_.add_request(bytes);
  const auto length = static_cast<std::int64_t>(outgoing_.bytes().size());
  if (is_long) line_free_ = now + length * byte_time_;
  last_request_ = now;
  last_request_rest_ = bytes.size() - 1;
}

// Of the commands that a robot may have got the beginning of, where the line was cut: a request is
// among them until it must have arrived.
std::size_t ControlCycle::longest_rest() const noexcept CARGOBAY_NONBLOCKING {
  const bool lately = woken_ - last_request_ < parameters_.link_timeout;
  const std::size_t rest = lately ? std::max(kLongestOwnRest, last_request_rest_) : kLongestOwnRest;
  return std::min(rest, Outgoing::kMostFill);
}

}  // namespace cargobay::hal
