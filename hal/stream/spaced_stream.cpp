#include "hal/stream/spaced_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace cargobay::hal {
namespace {

constexpr int kMostErrors = 2;  // one error proves nothing

}  // namespace

SpacedStream::SpacedStream(ByteStream& stream)
    : ForwardingStream{stream}, spaced_{oi::needs_spacing(stream.baud())} {}

SpacedStream::SpacedStream(std::unique_ptr<ByteStream> stream) : SpacedStream{*stream} {
  owned_ = std::move(stream);
}

SpacedStream::~SpacedStream() { (void)pass_on_all(now() + kMostBytes * kInterval); }

ByteStream::Wait SpacedStream::wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING {
  for (;;) {
    const std::optional<rt::TimePoint> due = begin_ < end_ ? pass_on() : std::nullopt;
    if (!due || *due >= deadline) return stream().wait(deadline);
    const Wait woken = stream().wait(*due);
    if (woken != Wait::timed_out) return woken;
  }
}

ByteStream::Transfer SpacedStream::write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  if (!spaced_) return stream().write(bytes);
  if (error_ != 0) return {.error = std::exchange(error_, 0)};
  if (begin_ > 0) {
    std::copy(kept_.begin() + begin_, kept_.begin() + end_, kept_.begin());
    end_ -= std::exchange(begin_, 0);
  }
  const auto taken = bytes.first(std::min(bytes.size(), kMostBytes - end_));
  std::copy(taken.begin(), taken.end(), kept_.begin() + end_);
  end_ += taken.size();
  (void)pass_on();
  return {.count = taken.size()};
}

std::optional<rt::TimePoint> SpacedStream::pass_on() CARGOBAY_NONBLOCKING {
  while (begin_ < end_) {
    if (now() < due_) return due_;
    // A program may have closed the port since these bytes were written.
    note(stream().still_open() ? stream().write(std::span{kept_}.subspan(begin_, 1))
                               : Transfer{.error = EBADF});
    due_ = now() + kInterval;
  }
  return std::nullopt;
}

void SpacedStream::note(const Transfer& transfer) CARGOBAY_NONBLOCKING {
  begin_ += transfer.count;
  const bool failed = transfer.error != 0 && transfer.error != EAGAIN;
  failures_ = failed ? failures_ + 1 : 0;
  if (failures_ < kMostErrors) return;
  error_ = transfer.error;
  failures_ = 0;
  begin_ = end_ = 0;
}

bool SpacedStream::pass_on_all(rt::TimePoint limit) {
  while (const std::optional<rt::TimePoint> due = pass_on()) {
    if (now() >= limit) return false;
    stream().sleep(std::min(*due, limit) - now());
  }
  return error_ == 0;
}

std::error_code SpacedStream::set_baud(std::uint32_t baud) {
  (void)pass_on_all(now() + kMostBytes * kInterval);
  const std::error_code error = stream().set_baud(baud);
  spaced_ = oi::needs_spacing(stream().baud());
  return error;
}

bool SpacedStream::drain(rt::Duration timeout) {
  const rt::TimePoint limit = now() + timeout;
  return pass_on_all(limit) && stream().drain(limit - now());
}

void SpacedStream::sleep(rt::Duration duration) {
  const rt::TimePoint until = now() + duration;
  for (;;) {
    const std::optional<rt::TimePoint> due = pass_on();
    if (!due || *due >= until) break;
    stream().sleep(*due - now());
  }
  stream().sleep(until - now());
}

}  // namespace cargobay::hal
