#include "hal/recording/exchange.hpp"

namespace cargobay::hal {
namespace {

// The clock is first asked right after the wait.
void add(const Entry& entry, Exchange& exchange, bool& timed) {
  switch (entry.kind) {
    case EntryKind::clock:
      if (!timed) exchange.time = entry.time;
      timed = true;
      break;
    case EntryKind::read:
      exchange.read.insert(exchange.read.end(), entry.bytes.begin(), entry.bytes.end());
      break;
    case EntryKind::wrote: {
      const auto taken = entry.bytes.first(entry.transfer.count);
      exchange.written.insert(exchange.written.end(), taken.begin(), taken.end());
      break;
    }
    case EntryKind::state: exchange.state = entry.state; break;
    case EntryKind::waited:
    case EntryKind::ended:
    case EntryKind::asked: break;
  }
}

}  // namespace

std::vector<Exchange> exchanges(std::span<const Recording::Block> blocks) {
  std::vector<Exchange> all;
  bool timed = false;
  Entry entry;
  for (EntryCursor cursor{blocks}; cursor.next(entry);) {
    if (entry.kind == EntryKind::waited) {
      all.push_back({.time = entry.time, .wait = entry.wait});
      timed = false;
    } else if (!all.empty()) {  // before the first wait, only the clock is asked
      add(entry, all.back(), timed);
    }
  }
  return all;
}

std::vector<Exchange> last_exchanges(const FlightRecorder& recorder, std::size_t frames) {
  std::vector<FlightRecorder::Block> kept;
  FlightRecorder::Cursor cursor;
  for (FlightRecorder::Block block; recorder.next(cursor, block);) kept.push_back(block);
  std::vector<Recording::Block> blocks;
  blocks.reserve(kept.size());
  for (const FlightRecorder::Block& block : kept)
    blocks.push_back({.number = block.number, .time = block.time, .entries = block.entries});
  std::vector<Exchange> all = exchanges(blocks);
  auto first = all.end();
  while (first != all.begin() && frames > 0) {
    --first;
    if (first->state.has_value()) --frames;
  }
  all.erase(all.begin(), first);
  return all;
}

}  // namespace cargobay::hal
