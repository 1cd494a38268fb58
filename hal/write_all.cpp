#include "hal/write_all.hpp"

#include <cerrno>
#include <chrono>

#include "oi/limits.hpp"

namespace cargobay::hal {
namespace {

constexpr std::chrono::milliseconds kQueuePatience{200};
constexpr std::uint32_t kSpacedBaud = 115200;
constexpr int kMostFailures = 2;

}  // namespace

bool write_all(ByteStream& stream, std::span<const std::uint8_t> bytes) {
  const bool spaced = stream.baud() >= kSpacedBaud;
  rt::TimePoint limit = stream.now() + kQueuePatience;
  int failures = 0;
  while (!bytes.empty()) {
    if (!stream.still_open()) return false;
    const auto part = spaced ? bytes.first(1) : bytes;
    const ByteStream::Transfer transfer = stream.write(part);
    bytes = bytes.subspan(transfer.count);
    const bool failed = transfer.error != 0 && transfer.error != EAGAIN;
    if (failed && ++failures >= kMostFailures) return false;
    if (spaced && transfer.count > 0) {
      stream.sleep(2 * oi::kByteSpacingAt115200);
      limit = stream.now() + kQueuePatience;
    } else if (!bytes.empty()) {
      if (stream.now() >= limit) return false;
      if (!stream.drain(limit - stream.now())) stream.sleep(std::chrono::milliseconds{1});
    }
  }
  return true;
}

}  // namespace cargobay::hal
