// What every stream in front of another stream has in common: set-up, shutdown and the clock's
// questions go straight through.
#pragma once

#include "hal/byte_stream.hpp"

namespace cargobay::hal {

class ForwardingStream : public ByteStream {
 public:
  Terminal terminal() const override { return stream_.terminal(); }
  std::uint32_t baud() const override { return stream_.baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return stream_.set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    return stream_.set_wake_threshold(bytes);
  }
  void discard_input() override { stream_.discard_input(); }
  bool drain(rt::Duration timeout) override { return stream_.drain(timeout); }

 protected:
  // `stream` outlives it.
  explicit ForwardingStream(ByteStream& stream) : stream_{stream} {}
  ByteStream& stream() { return stream_; }
  const ByteStream& stream() const { return stream_; }

 private:
  ByteStream& stream_;
};

}  // namespace cargobay::hal
