// A wrapper around another stream: everything goes straight through, except what a derived class
// overrides.
#pragma once

#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

class ForwardingStream : public ByteStream {
 public:
  // `stream` must outlive it.
  explicit ForwardingStream(ByteStream& stream) : stream_{stream} {}

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override { return stream_.wait(deadline); }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return stream_.read(bytes);
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return stream_.write(bytes);
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return stream_.now(); }
  bool still_open() const CARGOBAY_NONBLOCKING override { return stream_.still_open(); }

  Terminal terminal() const override { return stream_.terminal(); }
  std::uint32_t baud() const override { return stream_.baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return stream_.set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    return stream_.set_wake_threshold(bytes);
  }
  std::error_code set_modem_line(ModemLine line, bool asserted) override {
    return stream_.set_modem_line(line, asserted);
  }
  void discard_input() override { stream_.discard_input(); }
  bool drain(rt::Duration timeout) override { return stream_.drain(timeout); }
  void sleep(rt::Duration duration) override { stream_.sleep(duration); }

 protected:
  ByteStream& stream() { return stream_; }
  const ByteStream& stream() const { return stream_; }

 private:
  ByteStream& stream_;
};

}  // namespace cargobay::hal
