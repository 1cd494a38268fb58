#include "hal/sim/line/cable.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "rt/unchecked.hpp"

namespace cargobay::hal::sim {

namespace {

// Keeps the two directions and the robot's own noise from drawing the same numbers.
constexpr std::uint64_t kToRobotSeed = 0x746f2d726f626f74;
constexpr std::uint64_t kToHostSeed = 0x746f2d686f7374;
constexpr rt::Duration kLongestDrain = std::chrono::seconds{2};

}  // namespace

Cable::Cable(Device& device)
    : device_{&device},
      host_baud_{device.baud()},
      to_robot_faults_{device.parameters().seed ^ kToRobotSeed, kHostRoom},
      to_host_faults_{device.parameters().seed ^ kToHostSeed, kHostRoom} {}

void Cable::set_host_baud(std::uint32_t baud) {
  if (baud == host_baud_) return;
  device_->output().listen_again(now());
  to_robot_.cut_off(now() + kLongestDrain);
  host_baud_ = baud;
}

std::size_t Cable::send(std::span<const std::uint8_t> bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size() && to_robot_.push(now(), bytes[sent], host_baud_)) ++sent;
  return sent;
}

bool Cable::send(std::uint8_t byte, std::uint32_t baud, rt::Duration spacing) {
  return to_robot_.push(now(), byte, baud, spacing);
}

rt::Duration Cable::next_event() const {
  rt::Duration next = now() + device_->until_next_event();
  if (const auto held = to_robot_faults_.next()) next = std::min(next, *held);
  if (const auto held = to_host_faults_.next()) next = std::min(next, *held);
  if (const auto arrival = to_robot_.next_arrival(device_->baud())) next = std::min(next, *arrival);
  if (const auto arrival = device_->output().next_arrival(host_baud_))
    next = std::min(next, *arrival);
  if (!later_.empty()) next = std::min(next, later_.begin()->first);
  // If the robot's rate has just become faster, bytes may be over already.
  return std::max(next, now());
}

rt::Duration Cable::next_batch(std::size_t batch) const {
  rt::Duration next = now() + device_->until_next_event();
  if (const auto held = to_robot_faults_.next()) next = std::min(next, *held);
  if (const auto held = to_host_faults_.next()) next = std::min(next, *held);
  const auto consider = [&](const UartLine& line, std::uint32_t baud) {
    const auto whole_batch = line.batch_arrival(batch);
    const auto one_byte = line.next_arrival(baud);
    if (whole_batch && one_byte) next = std::min(next, std::max(*whole_batch, *one_byte));
  };
  consider(to_robot_, device_->baud());
  consider(device_->output(), host_baud_);
  if (!later_.empty()) next = std::min(next, later_.begin()->first);
  return std::max(next, now());
}

void Cable::advance_to(rt::Duration time) {
  for (;;) {
    const rt::Duration next = std::min(next_event(), time);
    device_->advance(next - now());
    // In virtual time the loop that waits is the one who moves it on.
    if (!later_.empty()) rt::unchecked([this] { do_what_is_due(); });
    move_to_robot();
    move_to_host();
    if (next >= time) return;
  }
}

void Cable::at(rt::Duration time, std::function<void(Cable&)> deed) {
  later_.emplace(time, std::move(deed));
  do_what_is_due();
}

void Cable::set_plugged(bool plugged) {
  // To put it back ends a silence too.
  const bool silent = !plugged && !on_plug;
  faults_to_host().unplugged = silent;
  faults_to_robot().unplugged = silent;
  if (on_plug) on_plug(plugged);
}

void Cable::do_what_is_due() {
  while (!later_.empty() && later_.begin()->first <= now()) {
    const auto due = later_.extract(later_.begin());
    due.mapped()(*this);
  }
}

void Cable::move_to_robot() {
  while (const auto arrival = to_robot_.pop(now(), device_->baud())) {
    if (arrival->framing_error) ++counters_.robot_framing_errors;
    if (to_robot_faults_.bypassed()) {
      device_->receive(arrival->value);
    } else {
      to_robot_faults_.push(now(), arrival->value);
    }
  }
  while (const auto byte = to_robot_faults_.pop(now())) device_->receive(*byte);
}

void Cable::move_to_host() {
  while (const auto arrival = device_->output().pop(now(), host_baud_)) {
    if (arrival->framing_error) ++counters_.host_framing_errors;
    if (to_host_faults_.bypassed()) {
      arrive_at_host(arrival->value);
    } else {
      to_host_faults_.push(now(), arrival->value);
    }
  }
  while (const auto byte = to_host_faults_.pop(now())) arrive_at_host(*byte);
}

void Cable::arrive_at_host(std::uint8_t byte) {
  if (!arrived_.push_back(byte)) ++counters_.host_overruns;
}

std::size_t Cable::take(std::span<std::uint8_t> bytes) {
  const std::size_t count = std::min(bytes.size(), arrived_.size());
  for (std::size_t i = 0; i < count; ++i) {
    bytes[i] = arrived_.front();
    arrived_.pop_front();
  }
  return count;
}

}  // namespace cargobay::hal::sim
