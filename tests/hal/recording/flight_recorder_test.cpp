#include "hal/recording/flight_recorder.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/recording/exchange.hpp"
#include "hal/recording/recording.hpp"
#include "tests/hal/recorded_drive.hpp"

namespace cargobay::hal {
namespace {

using std::chrono_literals::operator""ns;
using test::RecordedDrive;

constexpr rt::TimePoint kFirstArrival{rt::Duration{5'000'000'000}};

std::vector<Entry> entries_of(const FlightRecorder::Block& block) {
  std::vector<Entry> all;
  Entry entry;
  for (EntryReader reader{block.entries, block.time};
       reader.next(entry) == EntryReader::Outcome::entry;) {
    all.push_back(entry);
  }
  return all;
}

// All blocks available.
std::vector<FlightRecorder::Block> drained(const FlightRecorder& recorder,
                                           FlightRecorder::Cursor& cursor) {
  std::vector<FlightRecorder::Block> blocks;
  FlightRecorder::Block block;
  while (recorder.next(cursor, block)) blocks.push_back(block);
  return blocks;
}
std::vector<FlightRecorder::Block> drained(const FlightRecorder& recorder) {
  FlightRecorder::Cursor cursor;
  return drained(recorder, cursor);
}

TEST(FlightRecorder, HoldsNothingAtFirst) { EXPECT_TRUE(drained(FlightRecorder{}).empty()); }

TEST(FlightRecorder, GivesBackWhatItWasTold) {
  FlightRecorder recorder;
  const std::array<std::uint8_t, 3> frame{19, 0, 237};
  const std::array<std::uint8_t, 5> command{145, 0, 100, 0, 200};
  const CycleState state{.tick = -3,
                         .arrival = kFirstArrival,
                         .target = {-0.0, 1e-300},
                         .set = {1.5, -2.5},
                         .estimate = {std::numeric_limits<double>::infinity(), 0.1},
                         .command = {100.0, 200.0},
                         .remainder = rt::RemainderBelief::lost,
                         .mode = oi::Mode::safe,
                         .setpoint_lapsed = true,
                         .battery_mv = -7};
  recorder.waited(ByteStream::Wait::timed_out);
  recorder.clock(kFirstArrival);
  recorder.read(frame, 11);
  recorder.clock(kFirstArrival + 300ns);
  recorder.wrote(command, {.count = 4, .error = 5});
  recorder.state(state);
  recorder.ended(CycleEnd::link_lost);
  const auto blocks = drained(recorder);
  ASSERT_EQ(blocks.size(), 2U);
  const std::vector<Entry> told = entries_of(blocks[0]);
  ASSERT_EQ(told.size(), 6U);
  EXPECT_EQ(told[0].wait, ByteStream::Wait::timed_out);
  EXPECT_EQ(told[1].time, kFirstArrival);
  EXPECT_TRUE(std::ranges::equal(told[2].bytes, frame));
  EXPECT_EQ(told[2].transfer.error, 11);
  EXPECT_EQ(told[3].time, kFirstArrival + 300ns);
  EXPECT_TRUE(std::ranges::equal(told[4].bytes, command));
  EXPECT_EQ(told[4].transfer.count, 4U);
  EXPECT_EQ(told[4].transfer.error, 5);
  EXPECT_EQ(told[5].state.tick, -3);
  EXPECT_EQ(told[5].state.arrival, kFirstArrival);
  EXPECT_EQ(told[5].state.mode, oi::Mode::safe);
  EXPECT_EQ(told[5].state.target, state.target);
  EXPECT_TRUE(std::signbit(told[5].state.target.left_mm_s));
  EXPECT_EQ(told[5].state.set, state.set);
  EXPECT_EQ(told[5].state.estimate, state.estimate);
  EXPECT_EQ(told[5].state.command, state.command);
  EXPECT_EQ(told[5].state.remainder, rt::RemainderBelief::lost);
  EXPECT_TRUE(told[5].state.setpoint_lapsed);
  EXPECT_EQ(told[5].state.battery_mv, -7);
  EXPECT_EQ(entries_of(blocks[1])[0].end, CycleEnd::link_lost);
}

TEST(FlightRecorder, ShowsABlockWithTheStateOrOnceTheNextHasBegun) {
  FlightRecorder recorder;
  recorder.waited(ByteStream::Wait::ready);
  EXPECT_TRUE(drained(recorder).empty());
  recorder.waited(ByteStream::Wait::ready);
  EXPECT_EQ(drained(recorder).size(), 1U);
  recorder.state({});
  EXPECT_EQ(drained(recorder).size(), 2U);
}

TEST(FlightRecorder, StartsABlockWithTheTimeBefore) {
  FlightRecorder recorder;
  recorder.clock(kFirstArrival);
  recorder.waited(ByteStream::Wait::ready);
  recorder.clock(kFirstArrival + 7ns);
  recorder.ended(CycleEnd::asked);
  const auto blocks = drained(recorder);
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[1].time, kFirstArrival);
  EXPECT_EQ(entries_of(blocks[1])[1].time, kFirstArrival + 7ns);
}

TEST(FlightRecorder, SplitsWhatIsTooLongForABlock) {
  FlightRecorder recorder;
  const std::vector<std::uint8_t> bytes(kMostTransferBytes, 42);
  for (int i = 0; i < 3; ++i) recorder.read(bytes, 0);
  recorder.ended(CycleEnd::asked);
  const auto blocks = drained(recorder);
  ASSERT_EQ(blocks.size(), 3U);
  for (const auto& block : blocks)
    EXPECT_TRUE(std::ranges::equal(entries_of(block)[0].bytes, bytes));
}

TEST(FlightRecorder, KeepsTheLastAndCountsWhatIsGone) {
  FlightRecorder recorder{1};  // as small as it gets: 64 KiB
  const std::array<std::uint8_t, 200> bytes{};
  constexpr std::uint32_t kBlocks = 5000;
  for (std::uint32_t i = 0; i < kBlocks; ++i) {
    recorder.waited(ByteStream::Wait::ready);
    recorder.read(std::span{bytes}.first(i % bytes.size()), 0);
  }
  recorder.ended(CycleEnd::asked);
  FlightRecorder::Cursor cursor;
  const auto blocks = drained(recorder, cursor);
  ASSERT_GT(blocks.size(), 400U);
  EXPECT_LT(blocks.size(), 700U);
  EXPECT_EQ(blocks.back().number, kBlocks - 1);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    EXPECT_EQ(blocks[i].number, kBlocks - blocks.size() + i);
    EXPECT_EQ(entries_of(blocks[i])[1].bytes.size(), blocks[i].number % bytes.size());
  }
  // The cursor is at the end, and finds what comes.
  recorder.waited(ByteStream::Wait::ready);
  recorder.ended(CycleEnd::asked);
  EXPECT_EQ(drained(recorder, cursor).size(), 1U);
}

// The default size holds as much as the header says.
TEST(FlightRecorder, KeepsAHundredSecondsOfSteadyDriving) {
  RecordedDrive drive;
  drive.run(10'000);
  const auto blocks = drained(drive.recorder);
  EXPECT_GT(blocks.size(), 100'000U / 15U);
  EXPECT_EQ(blocks.back().number, 10'001U);
}

// A reader on another thread sees whole blocks in order, whichever it misses.
TEST(FlightRecorder, IsReadWhileItIsWritten) {
  FlightRecorder recorder{1};
  std::atomic<bool> over{false};
  std::uint64_t read = 0;
  std::uint64_t unsound = 0;
  std::thread reader{[&] {
    FlightRecorder::Cursor cursor;
    FlightRecorder::Block block;
    std::int64_t last = -1;
    for (bool last_round = false; !last_round;) {
      last_round = over.load(std::memory_order_acquire);  // pairs with the store below
      while (recorder.next(cursor, block)) {
        ++read;
        // Each block contains its number, many times.
        const std::vector<Entry> entries = entries_of(block);
        const auto value = static_cast<std::uint8_t>(block.number);
        const bool sound =
            entries.size() == 2 && entries[1].bytes.size() == std::size_t{100} + value &&
            std::ranges::all_of(entries[1].bytes, [&](std::uint8_t byte) { return byte == value; });
        if (!sound || block.number <= last) ++unsound;
        last = block.number;
      }
    }
  }};
  std::array<std::uint8_t, 355> bytes{};
  for (std::uint32_t i = 0; i < 200'000; ++i) {
    bytes.fill(static_cast<std::uint8_t>(i));
    recorder.waited(ByteStream::Wait::ready);
    recorder.read(std::span{bytes}.first(100 + i % 256), 0);
  }
  over.store(true, std::memory_order_release);
  reader.join();
  EXPECT_EQ(unsound, 0U);
  EXPECT_GT(read, 100U) << "what is still there at the end, at least";
}

TEST(FlightRecorder, HandsOutTheLastExchanges) {
  RecordedDrive drive;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    return drive.states.size() < 300 ? bytes.size() : 0;
  };
  drive.run(1000);
  ASSERT_EQ(drive.end, CycleEnd::link_lost);
  const std::vector<Exchange> last = last_exchanges(drive.recorder, 1000);
  const auto frames = static_cast<std::size_t>(
      std::ranges::count_if(last, [](const Exchange& it) { return it.state.has_value(); }));
  ASSERT_EQ(frames, 300U);
  EXPECT_GT(last.size(), frames) << "the time-outs of the silence are there too";
  EXPECT_EQ(last[299].state->tick, drive.states[299].tick);
  EXPECT_EQ(last[299].time, drive.states[299].arrival);
  EXPECT_EQ(last[299].read.size(), oi::kCreate.frame_bytes);
  EXPECT_EQ(last[299].written[0], 145);
  const std::vector<Exchange> fewer = last_exchanges(drive.recorder, 7);
  EXPECT_EQ(fewer.front().state->tick, drive.states[293].tick);
  EXPECT_EQ(fewer.back().time, last.back().time);
}

}  // namespace
}  // namespace cargobay::hal
