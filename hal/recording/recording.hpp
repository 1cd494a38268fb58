// A recording read from a file: checked as a whole, then gone through entry by entry.
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

// One thing that happened. Members that its kind does not have keep these values.
struct Entry {
  EntryKind kind = EntryKind::clock;
  rt::TimePoint time{};                   // what the clock last said
  ByteStream::Wait wait{};                // waited
  ByteStream::Transfer transfer{};        // read, wrote
  std::span<const std::uint8_t> bytes{};  // read: all of them; wrote: those offered
  CycleState state{};                     // state
  CycleEnd end{};                         // ended
  Request request{};                      // asked
};

// Goes through the entries of one block, which they point into.
class EntryReader {
 public:
  EntryReader(std::span<const std::uint8_t> entries, rt::TimePoint time)
      : in_{entries}, time_{time} {}

  enum class Outcome : std::uint8_t { entry, end, malformed };
  Outcome next(Entry& entry);

 private:
  void take(Entry& entry);

  ByteReader in_;
  rt::TimePoint time_;
};

// A block as it is in a file.
std::vector<std::uint8_t> encode(const FlightRecorder::Block& block);

class Recording {
 public:
  struct Block {
    std::uint32_t number = 0;
    rt::TimePoint time{};
    std::span<const std::uint8_t> entries{};
  };

  // `file`: all of it; must outlive the recording. Fails if it is not a recording, and if it is
  // damaged, saying at which byte: the message makes a sentence after the file's name.
  static Result<Recording> read(std::span<const std::uint8_t> file);

  const RecordingHeader& header() const { return header_; }
  const std::vector<Block>& blocks() const { return blocks_; }  // every entry in them is sound
  // Bytes after the last whole block of an unfinished recording: the power was cut, or the disk was
  // full.
  std::size_t cut_off_bytes() const { return cut_off_bytes_; }
  // Blocks that are missing, at the beginning or between others.
  std::uint64_t missing_blocks() const { return missing_blocks_; }
  // Blocks from the first up to the first missing one; 0 if that is the very first.
  std::size_t unbroken() const { return unbroken_; }

 private:
  RecordingHeader header_{};
  std::vector<Block> blocks_{};
  std::size_t cut_off_bytes_ = 0;
  std::uint64_t missing_blocks_ = 0;
  std::size_t unbroken_ = 0;
};

// Goes through the entries of checked blocks, one after another. Cheap to copy, to look ahead.
class EntryCursor {
 public:
  // The blocks must outlive it.
  explicit EntryCursor(std::span<const Recording::Block> blocks) : blocks_{blocks} {}
  // False after the last.
  bool next(Entry& entry);

 private:
  std::span<const Recording::Block> blocks_;  // not begun yet
  EntryReader entries_{{}, {}};
};

}  // namespace cargobay::hal
