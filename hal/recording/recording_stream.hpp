// A byte stream that reports to a flight recorder what the control thread does with it, and the
// results. Passes everything on; adds no system call.
#pragma once

#include "hal/recording/flight_recorder.hpp"
#include "hal/stream/forwarding_stream.hpp"

namespace cargobay::hal {

class RecordingStream final : public ForwardingStream {
 public:
  // Both must outlive it.
  RecordingStream(ByteStream& stream, FlightRecorder& recorder)
      : ForwardingStream{stream}, recorder_{recorder} {}

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override;
  // At most kMostTransferBytes at once, as if the port had or took no more.
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override;

 private:
  FlightRecorder& recorder_;
};

}  // namespace cargobay::hal
