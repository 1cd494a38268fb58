// The stream to a robot, for everything that writes to one. At 115200 baud the robot loses each
// byte that begins less than 200 us after the one before (OI p. 7), so at that rate this stream
// buffers what it is given and passes it on one byte at a time. At all other rates everything goes
// straight through.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "hal/stream/forwarding_stream.hpp"
#include "oi/limits.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {

class SpacedStream final : public ForwardingStream {
 public:
  // From one byte to the next: the 200 us, plus the 87 us of a byte that the UART may still be
  // sending when it is given the next.
  static constexpr std::chrono::microseconds kInterval{300};
  // The most that it buffers; of a longer write it takes only the first bytes.
  static constexpr std::size_t kMostBytes = 640;

  // `stream` must outlive it.
  explicit SpacedStream(ByteStream& stream);
  explicit SpacedStream(std::unique_ptr<ByteStream> stream);
  SpacedStream(const SpacedStream&) = delete;
  SpacedStream& operator=(const SpacedStream&) = delete;
  // First passes on what is still buffered: blocks for at most kInterval per byte.
  ~SpacedStream() override;

  // Buffered bytes are passed on in wait(), sleep() and drain(), the first of them in write() too.
  // A failed write is repeated once; if it fails again, the next write() returns the error, and
  // what was buffered is lost.
  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  // Below 115200 baud, the stream below this one.
  ByteStream& at_this_rate() override { return spaced_ ? *this : stream().at_this_rate(); }
  // All that was written before leaves at the previous rate.
  std::error_code set_baud(std::uint32_t baud) override;
  bool drain(rt::Duration timeout) override;
  void sleep(rt::Duration duration) override;

 private:
  // Passes on what is due. Returns when the next byte is due; nothing if none is left.
  std::optional<rt::TimePoint> pass_on() CARGOBAY_NONBLOCKING;
  void note(const Transfer& transfer) CARGOBAY_NONBLOCKING;
  bool pass_on_all(rt::TimePoint limit);

  std::unique_ptr<ByteStream> owned_{};
  bool spaced_ = false;
  int failures_ = 0;  // in a row
  int error_ = 0;
  rt::TimePoint due_{};  // no byte is passed on before
  std::array<std::uint8_t, kMostBytes> kept_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

// From the start of the first byte to the end of the last, of `bytes` written at once.
constexpr rt::Duration sending_time(std::size_t bytes, std::uint32_t baud) {
  if (bytes == 0 || !oi::needs_spacing(baud)) return oi::wire_time(bytes, baud);
  return static_cast<std::int64_t>(bytes - 1) * SpacedStream::kInterval + oi::wire_time(1, baud);
}

}  // namespace cargobay::hal
