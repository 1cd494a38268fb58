#include "hal/sensing/event_log.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

std::vector<std::int64_t> sequences(const EventLog& log, std::int64_t after) {
  std::vector<std::int64_t> found;
  while (const auto entry = log.next(after)) {
    found.push_back(entry->sequence);
    after = entry->sequence;
  }
  return found;
}

TEST(EventLog, GivesEveryReaderTheSame) {
  const auto log = std::make_unique<EventLog>();
  EXPECT_FALSE(log->next(0));
  log->put({.what = EventKind::bump_began});
  log->put({.what = EventKind::bump_ended});
  for (int reader = 0; reader < 4; ++reader)
    EXPECT_EQ(sequences(*log, 0), (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(log->next(1)->event.what, EventKind::bump_ended);
  EXPECT_EQ(log->last(), 2);
}

TEST(EventLog, KeepsTheNewestOfEachKindHoweverMuchFollows) {
  const auto log = std::make_unique<EventLog>();
  log->put({.what = EventKind::mode_lost, .mode = oi::Mode::full});
  log->put({.what = EventKind::mode_lost, .mode = oi::Mode::passive});
  for (std::size_t i = 0; i < kMostEvents + 164; ++i) log->put({.what = EventKind::bump_began});
  const auto first = log->next(0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->event.what, EventKind::mode_lost);
  EXPECT_EQ(first->event.mode, oi::Mode::passive);
  EXPECT_EQ(first->sequence, 2);
  const std::vector<std::int64_t> all = sequences(*log, 0);
  EXPECT_EQ(all.size(), kMostEvents + 1);
  EXPECT_EQ(all[1], 2 + 164 + 1) << "the gap shows";
  EXPECT_EQ(all.back(), log->last());
}

TEST(EventLog, GivesWhatIsKeptOnlyOnce) {
  const auto log = std::make_unique<EventLog>();
  log->put({.what = EventKind::mode_lost});
  for (std::size_t i = 0; i < kMostEvents - 1; ++i) log->put({.what = EventKind::bump_began});
  EXPECT_EQ(sequences(*log, 0).size(), kMostEvents) << "it is in the ring, too";
  log->put({.what = EventKind::bump_began});
  EXPECT_EQ(sequences(*log, 0).size(), kMostEvents + 1);
}

}  // namespace
}  // namespace cargobay::hal
