#include "hal/cycle/tick_ledger.hpp"

#include <chrono>

#include <gtest/gtest.h>

#include "hal/sensing/frame_lists.hpp"

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;

// A ledger and the line that it accounts for.
class TickLedgerTest : public testing::Test {
 protected:
  // `frames` whole ones, after `skipped` bytes, at these ticks of the robot.
  TickLedger::Account arrive(int tick, int frames = 1, std::uint64_t skipped = 0,
                             std::uint64_t corrupt = 0) {
    const auto framed = static_cast<std::uint64_t>(frames) * oi::kCreate.frame_bytes;
    bytes_.bytes += framed + skipped;
    bytes_.framed += framed;
    bytes_.skipped += skipped;
    return ledger_.book({.time = rt::TimePoint{tick * 15ms},
                         .frames = frames,
                         .corrupt = corrupt,
                         .bytes = bytes_});
  }

  FrameCounters counters_{};
  oi::StreamDecoder::Counters bytes_{};
  TickLedger ledger_{oi::kCreate.frame_bytes, 15ms, 5ms, counters_};
};

TEST_F(TickLedgerTest, CountsFromTheFirstFrame) {
  (void)arrive(100, 1, 3, 1);  // in the middle of a frame when listening began
  EXPECT_EQ(counters_.good, 1U);
  EXPECT_EQ(counters_.bad + counters_.lost, 0U);
  EXPECT_EQ(ledger_.clock().ticks(), 0);
  (void)arrive(101);
  EXPECT_EQ(ledger_.clock().ticks(), 1);
  EXPECT_EQ(ledger_.deadline(), rt::TimePoint{102 * 15ms + 5ms});
}

TEST_F(TickLedgerTest, TellsADamagedFrameFromALostOne) {
  (void)arrive(0);
  const TickLedger::Account damaged = arrive(2, 1, oi::kCreate.frame_bytes, 1);
  EXPECT_EQ(damaged.lost, 1);
  EXPECT_FALSE(damaged.never_came);
  EXPECT_FALSE(damaged.bytes_missing);
  EXPECT_EQ(counters_.bad, 1U);

  TickLedger::Account account = arrive(4);
  EXPECT_TRUE(account.bytes_missing);
  EXPECT_TRUE(account.incomplete);
  EXPECT_EQ(account.lost, 0) << "it may still come";
  for (int tick = 5; account.lost == 0 && tick < 20; ++tick) account = arrive(tick);
  EXPECT_EQ(account.lost, 1);
  EXPECT_TRUE(account.never_came);
  EXPECT_EQ(counters_.lost, 1U);
}

TEST_F(TickLedgerTest, TakesBackWhatComesAfterAll) {
  (void)arrive(0);
  TickLedger::Account account{};
  int tick = 2;
  for (; account.lost == 0 && tick < 20; ++tick) account = arrive(tick);
  ASSERT_EQ(counters_.lost, 1U);
  account = arrive(tick, 2);
  EXPECT_EQ(account.lost, -1);
  EXPECT_EQ(counters_.lost, 0U);
  EXPECT_EQ(counters_.good, static_cast<std::uint64_t>(tick) + 1U);
}

TEST_F(TickLedgerTest, HearsOfBytesThatNoFrameExplains) {
  (void)arrive(0);
  EXPECT_FALSE(arrive(1, 1, 2).says_more);
  EXPECT_TRUE(arrive(2, 1, 3 * oi::kCreate.frame_bytes).says_more);
}

TEST_F(TickLedgerTest, GoesThroughASilenceOnce) {
  (void)arrive(0);
  // At the deadline of the twelfth tick: twelve frames are due.
  EXPECT_EQ(ledger_.foresee(rt::TimePoint{12 * 15ms + 5ms}), 12);
  TickLedger::Account account = arrive(15);
  int to_step = account.to_step;
  int lost = account.lost;
  for (int tick = 16; lost == 0 && tick < 30; ++tick) {
    account = arrive(tick);
    to_step += account.to_step;
    lost += account.lost;
  }
  EXPECT_EQ(lost, 14);
  EXPECT_EQ(to_step, 2) << "twelve of them the loop has gone through";
  EXPECT_EQ(account.stepped_early, 0);
}

TEST_F(TickLedgerTest, GivesBackTheTicksOfASilenceWhoseFramesCome) {
  (void)arrive(0);
  ASSERT_EQ(ledger_.foresee(rt::TimePoint{12 * 15ms + 5ms}), 12);
  EXPECT_EQ(arrive(13, 13).stepped_early, 12);
}

TEST_F(TickLedgerTest, KnowsALateFrameAndOneThatIsOnTimeForCertain) {
  (void)arrive(0);
  EXPECT_FALSE(ledger_.on_time(2ms)) << "the phase is not known yet";
  int tick = 1;
  for (; tick <= rt::TickClock::kArrivalsToKnow + 1; ++tick) (void)arrive(tick);
  EXPECT_TRUE(ledger_.on_time(2ms));
  EXPECT_FALSE(ledger_.late());
  bytes_.bytes += oi::kCreate.frame_bytes;
  bytes_.framed += oi::kCreate.frame_bytes;
  (void)ledger_.book(
      {.time = rt::TimePoint{tick * 15ms + 6ms}, .frames = 1, .corrupt = 0, .bytes = bytes_});
  EXPECT_TRUE(ledger_.late());
  EXPECT_FALSE(ledger_.on_time(2ms));
  (void)arrive(tick + 2, 2);
  EXPECT_TRUE(ledger_.late()) << "of two together one was late";
}

TEST_F(TickLedgerTest, ClosesWithAllThatWasDue) {
  (void)arrive(0);
  (void)arrive(1);
  ledger_.close(rt::TimePoint{61 * 15ms});
  EXPECT_EQ(counters_.good, 2U);
  EXPECT_EQ(counters_.lost, 60U);
}

TEST_F(TickLedgerTest, HasNothingDueBeforeTheFirstFrame) {
  EXPECT_EQ(ledger_.foresee(rt::TimePoint{1s}), 0);
  ledger_.close(rt::TimePoint{1s});
  EXPECT_EQ(counters_.bad + counters_.lost, 0U);
}

}  // namespace
}  // namespace cargobay::hal
