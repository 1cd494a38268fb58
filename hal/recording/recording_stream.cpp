#include "hal/recording/recording_stream.hpp"

#include <algorithm>

namespace cargobay::hal {

ByteStream::Wait RecordingStream::wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING {
  const Wait outcome = stream().wait(deadline);
  if (outcome != Wait::left) recorder_.waited(outcome);
  return outcome;
}

ByteStream::Transfer RecordingStream::read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  const auto room = bytes.first(std::min(bytes.size(), kMostTransferBytes));
  const Transfer transfer = stream().read(room);
  recorder_.read(room.first(transfer.count), transfer.error);
  return transfer;
}

ByteStream::Transfer RecordingStream::write(std::span<const std::uint8_t> bytes)
    CARGOBAY_NONBLOCKING {
  const auto offered = bytes.first(std::min(bytes.size(), kMostTransferBytes));
  const Transfer transfer = stream().write(offered);
  recorder_.wrote(offered, transfer);
  return transfer;
}

rt::TimePoint RecordingStream::now() const CARGOBAY_NONBLOCKING {
  const rt::TimePoint now = stream().now();
  recorder_.clock(now);
  return now;
}

}  // namespace cargobay::hal
