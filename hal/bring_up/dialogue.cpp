#include "hal/bring_up/dialogue.hpp"

#include <algorithm>
#include <array>

#include "hal/stream/spaced_stream.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kSlice{20};  // a cancellation is noticed within this time
constexpr milliseconds kSettle{50};
constexpr std::size_t kLongestLine = 60;
constexpr std::size_t kLeastLine = 4;  // fewer characters may be damage by chance
constexpr std::size_t kMostUnreturned = 1024;

bool is_printable(std::uint8_t byte) { return byte >= 0x20 && byte < 0x7f; }

// Whether the frame carries exactly these packets, in this order.
bool carries(std::span<const std::uint8_t> frame, const oi::StreamList& packets,
             const oi::Dialect& dialect) {
  std::size_t at = 2;
  for (const oi::PacketId packet : packets) {
    const auto id = static_cast<std::uint8_t>(packet);
    if (at >= frame.size() || frame[at] != id) return false;
    at += 1 + dialect.packet_size(id);
  }
  return at + 1 == frame.size();
}

}  // namespace

void Dialogue::write(std::span<const std::uint8_t> bytes) {
  (void)write_all(stream_, bytes);
  const std::size_t room = kMostUnreturned - std::min(unreturned_.size(), kMostUnreturned);
  const auto kept = bytes.first(std::min(room, bytes.size()));
  unreturned_.insert(unreturned_.end(), kept.begin(), kept.end());
}

void Dialogue::resynchronise() {
  constexpr std::array<std::uint8_t, oi::kLongestRest> kZeros{};
  write(kZeros);
  pause(sending_time(oi::kLongestRest, stream_.baud()) + kSettle);
}

std::span<const std::uint8_t> Dialogue::take(TimePoint deadline) {
  if (cancelled_ && cancelled_()) was_cancelled_ = true;
  if (over()) return {};
  const TimePoint limit =
      cancelled_ ? std::min<TimePoint>(deadline, stream_.now() + kSlice) : deadline;
  const ByteStream::Wait woken = stream_.wait(limit);
  if (woken == ByteStream::Wait::hung_up) hung_up_ = true;
  if (woken != ByteStream::Wait::ready) return {};
  const ByteStream::Transfer transfer = stream_.read(bytes_);
  if (transfer.error != 0) hung_up_ = true;
  const std::span<const std::uint8_t> bytes{bytes_.data(), transfer.count};
  note(bytes);
  return bytes;
}

// A byte that was lost on the way back, or came from elsewhere, does not end an echo.
void Dialogue::note_echo(std::uint8_t byte) {
  if (byte == 0) return;
  ++heard_.nonzero;
  const auto same = std::ranges::find(unreturned_, byte);
  if (same == unreturned_.end()) return;
  ++heard_.echoed;
  unreturned_.erase(unreturned_.begin(), same + 1);
}

void Dialogue::note_source(TextSource source) {
  if (source == TextSource::unknown) return;
  heard_.source = source;
  heard_.known_line = line_;
}

void Dialogue::note(std::span<const std::uint8_t> bytes) {
  heard_.bytes += bytes.size();
  for (const std::uint8_t byte : bytes) {
    note_echo(byte);
    const bool ends_line = byte == '\r' || byte == '\n';
    if (is_printable(byte) || ends_line) ++heard_.printable;
    if (is_printable(byte)) {
      if (line_.size() < kLongestLine) line_.push_back(static_cast<char>(byte));
      continue;
    }
    if (ends_line && line_.size() >= kLeastLine) {
      heard_.last_line = line_;
      note_source(text_source(line_));
    }
    line_.clear();
  }
  note_source(prompt_source(line_));
}

bool Dialogue::wait_until(TimePoint deadline) {
  // Look once even if the deadline has passed.
  do {
    (void)take(deadline);  // what arrives meanwhile is only noted
  } while (!over() && stream_.now() < deadline);
  return !over();
}

FramesHeard Dialogue::listen(const oi::StreamList& packets, oi::Mode mode, int enough,
                             rt::Duration timeout) {
  FramesHeard heard;
  oi::StreamDecoder decoder{oi::Checksum::automatic, dialect_};
  const auto look = [&] {
    oi::SensorValues values;
    if (!carries(decoder.frame(), packets, dialect_) ||
        !oi::decode_frame(decoder.frame(), values, dialect_))
      return;
    ++heard.frames;
    heard.mode = values.mode();
    if (heard.mode == mode) ++heard.in_mode;
    if (values.has(oi::PacketId::voltage)) heard.battery_mv = values.raw(oi::PacketId::voltage);
  };
  const TimePoint until = stream_.now() + timeout;
  while (!over() && stream_.now() < until && heard.in_mode < enough) {
    decoder.push(take(until), [&](oi::StreamDecoder::Outcome outcome) {
      if (outcome == oi::StreamDecoder::Outcome::frame) look();
    });
  }
  return heard;
}

std::vector<std::uint8_t> Dialogue::reply(std::size_t bytes, rt::Duration timeout) {
  std::vector<std::uint8_t> all;
  const TimePoint until = stream_.now() + timeout;
  while (!over() && stream_.now() < until && all.size() < bytes) {
    const std::span<const std::uint8_t> come = take(until);
    all.insert(all.end(), come.begin(), come.end());
  }
  all.resize(std::min(all.size(), bytes));
  return all;
}

}  // namespace cargobay::hal
