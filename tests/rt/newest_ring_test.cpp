#include "rt/newest_ring.hpp"

#include <array>
#include <atomic>
#include <limits>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using Ring = NewestRing<int, 8>;

TEST(NewestRing, IsEmptyAtFirst) {
  const Ring ring;
  EXPECT_FALSE(ring.next(0));
  EXPECT_FALSE(ring.newest());
  EXPECT_EQ(ring.last(), 0);
}

TEST(NewestRing, GivesEachReaderWhatItHasNotSeen) {
  Ring ring;
  EXPECT_EQ(ring.put(10), 1);
  EXPECT_EQ(ring.put(20), 2);
  for (int reader = 0; reader < 3; ++reader) {
    const auto first = ring.next(0);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->number, 1);
    EXPECT_EQ(first->value, 10);
    EXPECT_EQ(ring.next(1)->value, 20);
    EXPECT_FALSE(ring.next(2));
  }
  EXPECT_EQ(ring.newest()->value, 20);
  EXPECT_FALSE(ring.next(std::numeric_limits<std::int64_t>::max()));
}

TEST(NewestRing, KeepsTheNewestAndShowsTheGap) {
  Ring ring;
  for (int i = 1; i <= 20; ++i) ring.put(i);
  const auto oldest = ring.next(0);
  ASSERT_TRUE(oldest);
  EXPECT_EQ(oldest->number, 13);
  EXPECT_EQ(oldest->value, 13);
  EXPECT_EQ(ring.next(15)->value, 16);
}

// Two words that always agree, so that a torn value shows.
struct Twins {
  std::int64_t one = 0;
  std::int64_t other = 0;
};

TEST(NewestRing, GivesWholeValuesInOrderWhileTwoThreadsPut) {
  constexpr std::int64_t kEach = 20'000;
  NewestRing<Twins, 64> ring;
  std::atomic<int> writing{2};
  std::vector<std::thread> threads;
  threads.reserve(5);
  for (int writer = 0; writer < 2; ++writer) {
    threads.emplace_back([&] {
      for (std::int64_t i = 1; i <= kEach; ++i) ring.put({i, i});
      writing.fetch_sub(1);
    });
  }
  std::array<bool, 3> whole{true, true, true};
  for (bool& fine : whole) {
    threads.emplace_back([&] {
      std::int64_t seen = 0;
      for (bool last = false; !last;) {
        last = writing.load() == 0;
        while (const auto next = ring.next(seen)) {
          fine = fine && next->number > seen && next->value.one == next->value.other;
          seen = next->number;
        }
      }
      fine = fine && seen == 2 * kEach;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(whole, (std::array{true, true, true}));
  EXPECT_EQ(ring.last(), 2 * kEach);
}

}  // namespace
}  // namespace cargobay::rt
