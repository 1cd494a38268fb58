#include "hal/stream/write_all.hpp"

#include <cerrno>
#include <chrono>

namespace cargobay::hal {
namespace {

constexpr std::chrono::milliseconds kQueuePatience{200};
constexpr int kMostFailures = 2;

}  // namespace

bool write_all(ByteStream& stream, std::span<const std::uint8_t> bytes) {
  const rt::TimePoint limit = stream.now() + kQueuePatience;
  int failures = 0;
  while (!bytes.empty()) {
    if (!stream.still_open()) return false;
    const ByteStream::Transfer transfer = stream.write(bytes);
    bytes = bytes.subspan(transfer.count);
    const bool failed = transfer.error != 0 && transfer.error != EAGAIN;
    if (failed && ++failures >= kMostFailures) return false;
    if (bytes.empty()) break;
    if (stream.now() >= limit) return false;
    if (!stream.drain(limit - stream.now())) stream.sleep(std::chrono::milliseconds{1});
  }
  return true;
}

}  // namespace cargobay::hal
