// A byte stream that damages what the robot sends before the host reads it, accepts less than the
// host gives it, or loses it on the way.
#pragma once

#include <cerrno>
#include <cstdint>
#include <functional>
#include <span>

#include "hal/stream/byte_stream.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal::test {

class DamagedStream final : public ByteStream {
 public:
  explicit DamagedStream(ByteStream& stream) : stream_{&stream} {}

  // Called before each wait.
  std::function<void()> before_wait{};
  // Called with what each read returned; may change it, and returns how many bytes remain.
  std::function<std::size_t(std::span<std::uint8_t>)> damage{};
  // Called with what is to be written; returns how many of its first bytes are accepted.
  std::function<std::size_t(std::span<const std::uint8_t>)> accept{};
  // Called with what was accepted; returns how many of its first bytes reach the robot.
  std::function<std::size_t(std::span<const std::uint8_t>)> carry{};

  // In virtual time the robot and the test's own functions run on the thread that waits: they may
  // allocate.
  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([this, deadline] {
      if (before_wait) before_wait();
      return stream_->wait(deadline);
    });
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    Transfer transfer = stream_->read(bytes);
    if (transfer.count > 0) {
      transfer.count = rt::unchecked(
          [&] { return damage ? damage(bytes.first(transfer.count)) : transfer.count; });
    }
    return transfer;
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    const std::size_t taken = rt::unchecked([&] { return accept ? accept(bytes) : bytes.size(); });
    if (taken == 0) return {.error = EAGAIN};
    const std::size_t carried = rt::unchecked([&] { return carry ? carry(bytes) : taken; });
    if (carried > 0) (void)stream_->write(bytes.first(carried));  // in virtual time it takes all
    return {.count = taken};
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return stream_->now(); }
  std::uint32_t baud() const override { return stream_->baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return stream_->set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    return stream_->set_wake_threshold(bytes);
  }
  void discard_input() override { stream_->discard_input(); }
  bool drain(rt::Duration timeout) override { return stream_->drain(timeout); }
  void sleep(rt::Duration duration) override { stream_->sleep(duration); }

 private:
  ByteStream* stream_;
};

}  // namespace cargobay::hal::test
