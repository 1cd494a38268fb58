#include "hal/recording/recording.hpp"

#include <algorithm>

namespace cargobay::hal {
namespace {

// Beyond any machine's uptime, and far from where sums of times overflow.
constexpr std::uint64_t kMostTime = std::uint64_t{1} << 60U;

bool take_errno(ByteReader& in, int& error) {
  std::uint64_t value = 0;
  if (!in.take_short(value) || value > 4095) return false;  // the kernel's bound
  error = static_cast<int>(value);
  return true;
}

bool take(ByteReader& in, rt::WheelSpeeds& speeds) {
  return in.take(speeds.left_mm_s) && in.take(speeds.right_mm_s);
}

bool take_read(ByteReader& in, Entry& entry) {
  std::uint64_t count = 0;
  if (!take_errno(in, entry.transfer.error) || !in.take_short(count) ||
      count > kMostTransferBytes || !in.take(static_cast<std::size_t>(count), entry.bytes)) {
    return false;
  }
  entry.transfer.count = static_cast<std::size_t>(count);
  return true;
}

bool take_wrote(ByteReader& in, Entry& entry) {
  std::uint64_t count = 0;
  std::uint64_t offered = 0;
  if (!take_errno(in, entry.transfer.error) || !in.take_short(count) || !in.take_short(offered) ||
      offered > kMostTransferBytes || count > offered ||
      !in.take(static_cast<std::size_t>(offered), entry.bytes)) {
    return false;
  }
  entry.transfer.count = static_cast<std::size_t>(count);
  return true;
}

bool take_request(ByteReader& in, Request& request) {
  std::uint8_t extras = 0;
  std::uint64_t size = 0;
  std::span<const std::uint8_t> bytes;
  if (!in.take(request.kind, Request::Kind::pose) || !in.take(extras) ||
      extras > kAllExtraLists.raw() || !in.take(request.when_long, Request::WhenLong::pause) ||
      !in.take_short(size) || size > Request::kMostBytes ||
      !in.take(static_cast<std::size_t>(size), bytes)) {
    return false;
  }
  request.extras = ExtraLists{extras};
  request.size = static_cast<std::uint8_t>(size);
  std::ranges::copy(bytes, request.bytes.begin());
  return in.take(request.pose.x_mm) && in.take(request.pose.y_mm) &&
         in.take(request.pose.heading_rad);
}

Failure damaged(std::size_t byte, const std::string& how) {
  return {"is damaged at byte " + std::to_string(byte) + ": " + how +
          "; what comes before it is intact; keep that with: head -c " + std::to_string(byte) +
          " FILE > OTHER"};
}

// One block from the front of `in`; nothing if it is not all there.
struct RawBlock {
  Recording::Block block{};
  bool sound = false;  // checksum and entries
};

bool sound(const Recording::Block& block) {
  EntryReader entries{block.entries, block.time};
  Entry entry;
  EntryReader::Outcome outcome{};
  while ((outcome = entries.next(entry)) == EntryReader::Outcome::entry) {
  }
  return outcome == EntryReader::Outcome::end;
}

std::optional<RawBlock> take_block(ByteReader& in) {
  const std::span<const std::uint8_t> from = in.rest();
  std::uint32_t length = 0;
  std::uint32_t checksum = 0;
  std::int64_t time_ns = 0;
  RawBlock raw;
  if (!in.take(length)) return std::nullopt;
  if (length > kMostBlockBytes) return raw;
  if (!in.take(raw.block.number) || !in.take(time_ns) || !in.take(length, raw.block.entries) ||
      !in.take(checksum)) {
    return std::nullopt;
  }
  raw.block.time = rt::TimePoint{rt::Duration{time_ns}};
  raw.sound = crc32(from.first(kBlockHeadBytes + length)) == checksum && time_ns >= 0 &&
              static_cast<std::uint64_t>(time_ns) <= kMostTime && sound(raw.block);
  return raw;
}

}  // namespace

EntryReader::Outcome EntryReader::next(Entry& entry) {
  if (in_.rest().empty()) return Outcome::end;
  entry = Entry{};
  const bool taken = take(entry);
  entry.time = time_;
  return taken ? Outcome::entry : Outcome::malformed;
}

bool EntryReader::take(Entry& entry) {
  std::uint8_t kind = 0;
  if (!in_.take(kind)) return false;
  entry.kind = static_cast<EntryKind>(kind);
  switch (entry.kind) {
    case EntryKind::waited: return in_.take(entry.wait, ByteStream::Wait::hung_up);
    case EntryKind::clock: return take_clock();
    case EntryKind::read: return take_read(in_, entry);
    case EntryKind::wrote: return take_wrote(in_, entry);
    case EntryKind::state: return take_state(entry.state);
    case EntryKind::ended: return in_.take(entry.end, CycleEnd::guard_lost);
    case EntryKind::asked: return take_request(in_, entry.request);
  }
  return false;
}

bool EntryReader::take_clock() {
  std::uint64_t since = 0;
  if (!in_.take_short(since) || since > kMostTime) return false;
  time_ += rt::Duration{static_cast<std::int64_t>(since)};
  return rt::nanoseconds(time_) <= static_cast<std::int64_t>(kMostTime);
}

bool EntryReader::take_state(CycleState& state) {
  std::uint64_t since = 0;
  std::uint8_t mode = 0;
  constexpr auto kMostTicks = static_cast<std::int64_t>(kMostTime);
  if (!in_.take_short(since) || since > kMostTime || !in_.take(state.tick) ||
      state.tick > kMostTicks || state.tick < -kMostTicks || !in_.take(mode)) {
    return false;
  }
  state.arrival = time_ - rt::Duration{static_cast<std::int64_t>(since)};
  state.mode = static_cast<oi::Mode>(mode);  // as the robot sent it, known or not
  return in_.take(state.remainder, rt::RemainderBelief::lost) && in_.take(state.setpoint_lapsed) &&
         in_.take(state.battery_mv) && hal::take(in_, state.target) && hal::take(in_, state.set) &&
         hal::take(in_, state.estimate) && hal::take(in_, state.command);
}

bool EntryCursor::next(Entry& entry) {
  while (entries_.next(entry) != EntryReader::Outcome::entry) {
    if (blocks_.empty()) return false;
    entries_ = EntryReader{blocks_.front().entries, blocks_.front().time};
    blocks_ = blocks_.subspan(1);
  }
  return true;
}

std::vector<std::uint8_t> encode(const FlightRecorder::Block& block) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(kBlockHeadBytes + block.entries.size() + kChecksumBytes);
  const auto put = [&bytes](const auto& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  put(little_endian(static_cast<std::uint32_t>(block.entries.size())));
  put(little_endian(block.number));
  put(little_endian(static_cast<std::uint64_t>(rt::nanoseconds(block.time))));
  put(block.entries);
  put(little_endian(crc32(bytes)));
  return bytes;
}

Result<Recording> Recording::read(std::span<const std::uint8_t> file) {
  auto decoded = decode_header(file);
  if (!decoded) return decoded.failure();
  Recording recording;
  recording.header_ = std::move(decoded->header);
  ByteReader in{file.subspan(decoded->bytes)};
  std::uint64_t expected = 0;
  while (!in.rest().empty()) {
    const std::size_t left = in.rest().size();
    const auto raw = take_block(in);
    if (!raw) {
      recording.cut_off_bytes_ = left;
      break;
    }
    const std::size_t at = file.size() - left;
    if (!raw->sound) return damaged(at, "the block there is not what was written");
    if (raw->block.number < expected) return damaged(at, "the block there is out of order");
    recording.missing_blocks_ += raw->block.number - expected;
    expected = std::uint64_t{raw->block.number} + 1;
    recording.blocks_.push_back(raw->block);
    if (recording.missing_blocks_ == 0) ++recording.unbroken_;
  }
  return recording;
}

}  // namespace cargobay::hal
