// A byte stream that tells a flight recorder what the control thread does with it, and what comes
// of it. Passes everything on; adds no system call.
#pragma once

#include "hal/byte_stream.hpp"
#include "hal/flight_recorder.hpp"

namespace cargobay::hal {

class RecordingStream final : public ByteStream {
 public:
  // Both outlive it.
  RecordingStream(ByteStream& stream, FlightRecorder& recorder)
      : stream_{stream}, recorder_{recorder} {}

  Wait wait(rt::TimePoint deadline) noexcept CARGOBAY_NONBLOCKING override;
  // At most kMostTransferBytes at once, as of a port that has or takes no more.
  Transfer read(std::span<std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override;
  rt::TimePoint now() const noexcept CARGOBAY_NONBLOCKING override;

  std::uint32_t baud() const override { return stream_.baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return stream_.set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    return stream_.set_wake_threshold(bytes);
  }
  void discard_input() override { stream_.discard_input(); }
  bool drain(rt::Duration timeout) override { return stream_.drain(timeout); }

 private:
  ByteStream& stream_;
  FlightRecorder& recorder_;
};

}  // namespace cargobay::hal
