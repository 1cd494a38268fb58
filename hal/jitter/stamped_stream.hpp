// A stream that notes when its user woke and when its command was handed to the kernel: two clock
// reads per frame, and nothing else between the loop and its port.
#pragma once

#include "hal/jitter/frame_source.hpp"
#include "hal/stream/forwarding_stream.hpp"

namespace cargobay::hal::jitter {

class StampedStream final : public ForwardingStream {
 public:
  // Both outlive it. `baud` is the rate it claims to have: for short ticks, one to match.
  StampedStream(ByteStream& stream, Stamps& stamps, std::uint32_t baud)
      : ForwardingStream{stream}, stamps_{stamps}, baud_{baud} {}

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    const Wait woken = stream().wait(deadline);
    stamps_.woken_ns.store(rt::nanoseconds(stream().now()), std::memory_order_relaxed);
    return woken;
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    const Transfer transfer = stream().write(bytes);
    stamps_.written_ns.store(rt::nanoseconds(stream().now()), std::memory_order_relaxed);
    // Pairs with the source's load: the stamps before it are this answer's.
    stamps_.answers.fetch_add(1, std::memory_order_release);
    return transfer;
  }
  std::uint32_t baud() const override { return baud_; }

 private:
  Stamps& stamps_;
  std::uint32_t baud_;
};

}  // namespace cargobay::hal::jitter
