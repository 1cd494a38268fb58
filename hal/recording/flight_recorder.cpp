#include "hal/recording/flight_recorder.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace cargobay::hal {
namespace {

constexpr std::size_t kLeastBytes = std::size_t{64} << 10U;
constexpr std::size_t kWordBytes = sizeof(std::uint64_t);

constexpr std::uint64_t words_of(std::uint64_t bytes) CARGOBAY_NONBLOCKING {
  return (bytes + kWordBytes - 1) / kWordBytes;
}

// The first word of a block.
constexpr std::uint64_t head(std::uint32_t number, std::uint64_t length) CARGOBAY_NONBLOCKING {
  return std::uint64_t{number} << 32U | length;
}
constexpr std::uint64_t length_of(std::uint64_t head) CARGOBAY_NONBLOCKING {
  return head & 0xFFFFFFFFU;
}

}  // namespace

FlightRecorder::FlightRecorder(std::size_t bytes)
    : words_(std::bit_ceil(std::max(bytes, kLeastBytes)) / kWordBytes), mask_{words_.size() - 1} {}

// Any entry fits into an empty block.
void FlightRecorder::note(EntryKind kind, const auto& fields, const auto&... values)
    CARGOBAY_NONBLOCKING {
  MostBytes most;
  most.raw(kind);
  fields(most, values...);
  if (entries_.size() + most.count() > kMostBlockBytes) close_block();
  ByteWriter out{[this](const auto& bytes) {  // of constant size, most of them
    [[maybe_unused]] const bool fit = entries_.append(bytes);
    assert(fit);
  }};
  out.raw(kind);
  fields(out, values...);
}

void FlightRecorder::waited(ByteStream::Wait outcome) CARGOBAY_NONBLOCKING {
  close_block();
  note(EntryKind::waited, kWaitedFields, outcome);
}

void FlightRecorder::clock(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  note(EntryKind::clock, kClockFields, (now - time_).count());
  time_ = now;
}

void FlightRecorder::read(std::span<const std::uint8_t> bytes, int error) CARGOBAY_NONBLOCKING {
  assert(bytes.size() <= kMostTransferBytes);
  note(EntryKind::read, kReadFields, error, bytes);
}

void FlightRecorder::wrote(std::span<const std::uint8_t> offered, ByteStream::Transfer transfer)
    CARGOBAY_NONBLOCKING {
  assert(offered.size() <= kMostTransferBytes);
  note(EntryKind::wrote, kWroteFields, transfer, offered);
}

void FlightRecorder::state(const CycleState& state) CARGOBAY_NONBLOCKING {
  note(EntryKind::state, kStateFields, state, (time_ - state.arrival).count());
  close_block();
}

void FlightRecorder::asked(const Request& request) CARGOBAY_NONBLOCKING {
  note(EntryKind::asked, kAskedFields, request);
}

StateObserver FlightRecorder::observer() {
  constexpr auto kSee = [](void* recorder, const CycleState& state) CARGOBAY_NONBLOCKING {
    static_cast<FlightRecorder*>(recorder)->state(state);
  };
  constexpr auto kHear = [](void* recorder, const Request& request) CARGOBAY_NONBLOCKING {
    static_cast<FlightRecorder*>(recorder)->asked(request);
  };
  return {.function = kSee, .context = this, .request = kHear};
}

void FlightRecorder::ended(CycleEnd end) CARGOBAY_NONBLOCKING {
  note(EntryKind::ended, kEndedFields, end);
  close_block();
}

void FlightRecorder::close_block() CARGOBAY_NONBLOCKING {
  if (entries_.empty()) return;
  const std::uint64_t words = kHeadWords + words_of(entries_.size());
  make_room(words);
  const std::uint64_t at = end_.load(std::memory_order_relaxed);
  // Release: a reader that sees one of these words also sees that the oldest blocks have gone.
  word(at).store(head(number_, entries_.size()), std::memory_order_release);
  word(at + 1).store(static_cast<std::uint64_t>(rt::nanoseconds(block_time_)),
                     std::memory_order_release);
  for (std::size_t i = 0; i < entries_.size(); i += kWordBytes) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, entries_.data() + i, std::min(kWordBytes, entries_.size() - i));
    word(at + kHeadWords + i / kWordBytes).store(bits, std::memory_order_release);
  }
  end_.store(at + words, std::memory_order_release);  // pairs with the first load of next()
  ++number_;
  block_time_ = time_;
  entries_.clear();
}

// Gives up the oldest blocks until `words` are free.
void FlightRecorder::make_room(std::uint64_t words) CARGOBAY_NONBLOCKING {
  const std::uint64_t needed = end_.load(std::memory_order_relaxed) + words;
  std::uint64_t oldest = oldest_.load(std::memory_order_relaxed);
  while (needed - oldest > words_.size()) {  // at most once for every two words
    oldest += kHeadWords + words_of(length_of(word(oldest).load(std::memory_order_relaxed)));
  }
  // Before the words that overwrite them, each of which is stored with release.
  oldest_.store(oldest, std::memory_order_relaxed);
}

bool FlightRecorder::next(Cursor& cursor, Block& block) const {
  for (;;) {
    const std::uint64_t end = end_.load(std::memory_order_acquire);  // pairs with close_block()
    cursor.word_ = std::max(cursor.word_, oldest_.load(std::memory_order_relaxed));
    if (cursor.word_ >= end) return false;
    // Acquire: if a word is newer, the load of oldest_ below sees that its block was overwritten.
    const std::uint64_t first = word(cursor.word_).load(std::memory_order_acquire);
    const auto length =
        static_cast<std::size_t>(std::min<std::uint64_t>(length_of(first), kMostBlockBytes));
    block.number = static_cast<std::uint32_t>(first >> 32U);
    block.time = rt::TimePoint{rt::Duration{
        static_cast<std::int64_t>(word(cursor.word_ + 1).load(std::memory_order_acquire))}};
    block.entries.resize(length);
    for (std::size_t i = 0; i < length; i += kWordBytes) {
      const std::uint64_t bits =
          word(cursor.word_ + kHeadWords + i / kWordBytes).load(std::memory_order_acquire);
      std::memcpy(block.entries.data() + i, &bits, std::min<std::size_t>(kWordBytes, length - i));
    }
    if (oldest_.load(std::memory_order_relaxed) > cursor.word_) continue;  // overwritten meanwhile
    cursor.word_ += kHeadWords + words_of(length);
    return true;
  }
}

}  // namespace cargobay::hal
