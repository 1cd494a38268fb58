// Keeps the last minutes of what a control cycle received and did: the result of each wait, read
// and write, what the clock said, and the state of each tick. A cycle that is given the same input
// again does the same again (hal/recording/replay.hpp).
//
// The control thread writes, wait-free, into a ring that overwrites its oldest blocks: no heap, no
// lock, no system call. Any number of other threads may read meanwhile, and never hold it up.
// In the steady state one tick is one block of about 140 bytes, so that 1 MiB keeps about 7400, or
// 110 s. It reaches back further while a robot is silent, less far if its bytes come in pieces.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/recording_format.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/fixed_list.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class FlightRecorder {
 public:
  static constexpr std::size_t kDefaultBytes = std::size_t{1} << 20U;

  // Allocates and touches all its memory: a power of two, at least `bytes` and 64 KiB.
  explicit FlightRecorder(std::size_t bytes = kDefaultBytes);

  // From the control thread, in the order of what happened. waited() begins a block and state()
  // ends one, so that the work for it comes after the command; then readers can see it. At most
  // kMostTransferBytes per read or write.
  void waited(ByteStream::Wait outcome) CARGOBAY_NONBLOCKING;
  void clock(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  void read(std::span<const std::uint8_t> bytes, int error) CARGOBAY_NONBLOCKING;
  void wrote(std::span<const std::uint8_t> offered, ByteStream::Transfer transfer)
      CARGOBAY_NONBLOCKING;
  void state(const CycleState& state) CARGOBAY_NONBLOCKING;
  void asked(const Request& request) CARGOBAY_NONBLOCKING;
  // Set this in the cycle that is recorded; it calls state() and asked().
  StateObserver observer();
  // The memory that the calls from the control thread touch, besides the recorder itself.
  std::span<const std::byte> memory() const { return std::as_bytes(std::span{words_}); }
  // The last call; makes everything visible.
  void ended(CycleEnd end) CARGOBAY_NONBLOCKING;

  // As in hal/recording/recording_format.hpp.
  struct Block {
    std::uint32_t number = 0;
    rt::TimePoint time{};
    std::vector<std::uint8_t> entries{};
  };
  // Where a reader is: at first the beginning, or the oldest block that is still there.
  class Cursor {
    friend class FlightRecorder;
    std::uint64_t word_ = 0;
  };
  // From any thread, with its own cursor: the next block; false if there is none yet. Blocks that
  // were overwritten before they were read leave a gap in `block.number`. Allocates.
  bool next(Cursor& cursor, Block& block) const;

 private:
  static constexpr std::uint64_t kHeadWords = 2;  // number and length, time

  // An entry of this kind, made from its list of fields in hal/recording/recording_format.hpp.
  void note(EntryKind kind, const auto& fields, const auto&... values) CARGOBAY_NONBLOCKING;
  void close_block() CARGOBAY_NONBLOCKING;
  void make_room(std::uint64_t words) CARGOBAY_NONBLOCKING;

  std::atomic<std::uint64_t>& word(std::uint64_t position) CARGOBAY_NONBLOCKING {
    return words_[static_cast<std::size_t>(position & mask_)];
  }
  const std::atomic<std::uint64_t>& word(std::uint64_t position) const {
    return words_[static_cast<std::size_t>(position & mask_)];
  }

  // The open block; the control thread's own.
  oi::FixedList<std::uint8_t, kMostBlockBytes> entries_{};
  std::uint32_t number_ = 0;
  rt::TimePoint block_time_{};
  rt::TimePoint time_{};

  // Positions count words since the beginning; the ring holds those from oldest_ to end_.
  std::vector<std::atomic<std::uint64_t>> words_;
  std::uint64_t mask_;
  std::atomic<std::uint64_t> oldest_{0};
  std::atomic<std::uint64_t> end_{0};
};

}  // namespace cargobay::hal
