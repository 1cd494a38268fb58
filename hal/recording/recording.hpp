// A recording as it was read from a file: checked as a whole, then gone through entry by entry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_format.hpp"
#include "hal/recording/recording_header.hpp"
#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// One thing that happened. What its kind does not have is as it is here.
struct Entry {
  EntryKind kind = EntryKind::clock;
  rt::TimePoint time{};                   // what the clock had said last
  ByteStream::Wait wait{};                // waited
  ByteStream::Transfer transfer{};        // read, wrote
  std::span<const std::uint8_t> bytes{};  // read: all of them; wrote: those offered
  CycleState state{};                     // state
  CycleEnd end{};                         // ended
  Request request{};                      // asked
};

// Goes through the entries of one block; they and what they point to are the block's.
class EntryReader {
 public:
  EntryReader(std::span<const std::uint8_t> entries, rt::TimePoint time)
      : in_{entries}, time_{time} {}

  enum class Outcome : std::uint8_t { entry, end, malformed };
  Outcome next(Entry& entry);

 private:
  bool take(Entry& entry);
  bool take_clock();
  bool take_state(CycleState& state);

  ByteReader in_;
  rt::TimePoint time_;
};

// A block as it stands in a file.
std::vector<std::uint8_t> encode(const FlightRecorder::Block& block);

class Recording {
 public:
  struct Block {
    std::uint32_t number = 0;
    rt::TimePoint time{};
    std::span<const std::uint8_t> entries{};
  };

  // `file`: all of it; it outlives the recording. Fails for what is none, and for damage, saying at
  // which byte: behind the name of the file the message makes a sentence.
  static Result<Recording> read(std::span<const std::uint8_t> file);

  const RecordingHeader& header() const { return header_; }
  const std::vector<Block>& blocks() const { return blocks_; }  // every entry in them is sound
  // Bytes behind the last whole block, of one that was not finished: the power was cut, or the disk
  // was full.
  std::size_t cut_off_bytes() const { return cut_off_bytes_; }
  // Blocks that are missing, at the beginning or between others.
  std::uint64_t missing_blocks() const { return missing_blocks_; }
  // Blocks from the first up to the first that is missing; 0 where that is the very first.
  std::size_t unbroken() const { return unbroken_; }

 private:
  RecordingHeader header_{};
  std::vector<Block> blocks_{};
  std::size_t cut_off_bytes_ = 0;
  std::uint64_t missing_blocks_ = 0;
  std::size_t unbroken_ = 0;
};

// Goes through the entries of blocks that were checked, one behind the other. Cheap to copy, for a
// look ahead.
class EntryCursor {
 public:
  // The blocks outlive it.
  explicit EntryCursor(std::span<const Recording::Block> blocks) : blocks_{blocks} {}
  // False behind the last.
  bool next(Entry& entry);

 private:
  std::span<const Recording::Block> blocks_;  // not begun yet
  EntryReader entries_{{}, {}};
};

}  // namespace cargobay::hal
