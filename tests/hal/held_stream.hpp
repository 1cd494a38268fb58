// A byte stream on which what the robot sends is held up on its way to the host: by an adapter that
// delivers now and then, by a kernel that is busy with other things. In virtual time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal::test {

class HeldStream final : public ByteStream {
 public:
  explicit HeldStream(sim::VirtualLink& link) : link_{&link} {}

  // When bytes that arrive at a given time are delivered: not before that time, and in order.
  // Empty: at once.
  std::function<rt::TimePoint(rt::TimePoint arrival)> hand_over{};

  // In virtual time nothing waits for these allocations.
  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([this, deadline] { return wait_for_bytes(deadline); });
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([this, bytes] { return take_ready(bytes); });
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return link_->write(bytes);
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return link_->now(); }

  std::uint32_t baud() const override { return link_->baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return link_->set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    wake_threshold_ = bytes;
    return {};
  }
  void discard_input() override {
    link_->discard_input();
    bytes_.clear();
    ready_ = 0;
  }
  bool drain(rt::Duration timeout) override { return link_->drain(timeout); }
  void sleep(rt::Duration duration) override { link_->sleep(duration); }

 private:
  struct Held {
    rt::TimePoint due{};
    std::uint8_t value = 0;
  };

  Wait wait_for_bytes(rt::TimePoint deadline) {
    for (;;) {
      release();
      if (ready_ >= wake_threshold_) return Wait::ready;
      if (now() >= deadline) return Wait::timed_out;
      const bool holds = ready_ < bytes_.size();
      const rt::TimePoint next =
          holds ? std::min(deadline, std::max(bytes_[ready_].due, now())) : deadline;
      if (link_->wait(next) == Wait::hung_up) return Wait::hung_up;
      take();
    }
  }
  Transfer take_ready(std::span<std::uint8_t> bytes) {
    release();
    const std::size_t count = std::min(bytes.size(), ready_);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = bytes_[i].value;
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
    ready_ -= count;
    return {.count = count};
  }
  // The link wakes for each byte, so now is when it arrived.
  void take() {
    std::uint8_t byte = 0;
    while (link_->read({&byte, 1}).count == 1) {
      rt::TimePoint due = hand_over ? hand_over(now()) : now();
      if (!bytes_.empty()) due = std::max(due, bytes_.back().due);
      bytes_.push_back({due, byte});
    }
  }
  void release() {
    take();
    while (ready_ < bytes_.size() && bytes_[ready_].due <= now()) ++ready_;
  }

  sim::VirtualLink* link_;
  std::vector<Held> bytes_;  // in order; the first ready_ of them can be read
  std::size_t ready_ = 0;
  std::size_t wake_threshold_ = 1;
};

}  // namespace cargobay::hal::test
