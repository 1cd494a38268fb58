#include "hal/recording/recording.hpp"

#include <algorithm>

namespace cargobay::hal {
namespace {

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

// What comes before the entries.
void block_head(auto& io, std::uint32_t& length, auto& block) {
  io.raw(length, block.number, block.time);
}

std::optional<RawBlock> take_block(ByteReader& in) {
  const std::span<const std::uint8_t> from = in.rest();
  std::uint32_t length = 0;
  std::uint32_t checksum = 0;
  RawBlock raw;
  block_head(in, length, raw.block);
  if (length > kMostBlockBytes) return raw;
  raw.block.entries = in.take(length);
  in.raw(checksum);
  if (!in.sound()) return std::nullopt;
  const std::int64_t time_ns = rt::nanoseconds(raw.block.time);
  raw.sound = crc32(from.first(kBlockHeadBytes + length)) == checksum && time_ns >= 0 &&
              time_ns <= kMostTime && sound(raw.block);
  return raw;
}

}  // namespace

EntryReader::Outcome EntryReader::next(Entry& entry) {
  if (in_.rest().empty()) return Outcome::end;
  entry = Entry{};
  take(entry);
  entry.time = time_;
  return in_.sound() ? Outcome::entry : Outcome::malformed;
}

void EntryReader::take(Entry& entry) {
  rt::Duration::rep ns = 0;
  in_.up_to(entry.kind, EntryKind::asked);
  in_.require(entry.kind >= EntryKind::waited);
  switch (entry.kind) {
    case EntryKind::waited: kWaitedFields(in_, entry.wait); break;
    case EntryKind::clock:
      kClockFields(in_, ns);
      time_ += rt::Duration{ns};
      in_.require(rt::nanoseconds(time_) <= kMostTime);
      break;
    case EntryKind::read:
      kReadFields(in_, entry.transfer.error, entry.bytes);
      entry.transfer.count = entry.bytes.size();
      break;
    case EntryKind::wrote: kWroteFields(in_, entry.transfer, entry.bytes); break;
    case EntryKind::state:
      kStateFields(in_, entry.state, ns);
      entry.state.arrival = time_ - rt::Duration{ns};
      break;
    case EntryKind::ended: kEndedFields(in_, entry.end); break;
    case EntryKind::asked: kAskedFields(in_, entry.request); break;
  }
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
  auto out = writer_to(bytes);
  auto length = static_cast<std::uint32_t>(block.entries.size());
  block_head(out, length, block);
  bytes.insert(bytes.end(), block.entries.begin(), block.entries.end());
  out.raw(crc32(bytes));
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
