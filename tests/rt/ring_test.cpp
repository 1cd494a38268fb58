#include "rt/ring.hpp"

#include <atomic>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "tests/rt/stress.hpp"

namespace cargobay::rt {
namespace {

TEST(SpscRing, GivesBackInOrder) {
  SpscRing<int, 8> ring;
  int value = 0;
  EXPECT_FALSE(ring.pop(value));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(ring.push(i));
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
  EXPECT_EQ(value, 4) << "an empty ring leaves the value alone";
}

TEST(SpscRing, HoldsItsCapacityAndCountsWhatItDrops) {
  SpscRing<int, 4> ring;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_EQ(ring.dropped(), 0U);
  EXPECT_FALSE(ring.push(4));
  EXPECT_FALSE(ring.push(5));
  EXPECT_EQ(ring.dropped(), 2U);
  int value = -1;
  ASSERT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 0) << "the oldest stay, the newest are dropped";
  EXPECT_TRUE(ring.push(6));
  EXPECT_EQ(ring.dropped(), 2U);
}

TEST(SpscRing, GoesRoundManyTimes) {
  SpscRing<std::uint64_t, 4> ring;
  std::uint64_t pushed = 0;
  std::uint64_t popped = 0;
  for (int round = 0; round < 10'000; ++round) {
    const int count = round % 5;
    for (int i = 0; i < count; ++i) ASSERT_TRUE(ring.push(pushed++));
    for (int i = 0; i < count; ++i) {
      std::uint64_t value = 0;
      ASSERT_TRUE(ring.pop(value));
      ASSERT_EQ(value, popped++);
    }
  }
}

struct Event {
  std::uint64_t number = 0;
  std::uint64_t twice = 0;
};

TEST(SpscRing, HandsOverEveryEventOnceAndWhole) {
  SpscRing<Event, 64> ring;
  constexpr std::uint64_t kEvents = 100'000;
  std::uint64_t pushed = 0;
  std::uint64_t expected = 0;
  std::uint64_t wrong = 0;
  const bool done = test::contend(
      [&] {
        if (pushed < kEvents && ring.push({pushed, 2 * pushed})) ++pushed;
      },
      [&] {
        Event event;
        if (!ring.pop(event)) return false;
        if (event.number != expected || event.twice != 2 * expected) ++wrong;
        ++expected;
        return expected == kEvents;
      },
      std::chrono::seconds{30});
  EXPECT_TRUE(done);
  EXPECT_EQ(wrong, 0U);
}

// What does not fit is dropped; the rest comes in order.
TEST(SpscRing, LosesNothingThatItDidNotCount) {
  SpscRing<Event, 2> ring;
  std::atomic<std::uint64_t> pushed{0};
  std::uint64_t popped = 0;
  std::uint64_t newest = 0;
  std::uint64_t wrong = 0;
  const auto take = [&] {
    Event event;
    if (!ring.pop(event)) return false;
    ++popped;
    if (event.number <= newest || event.twice != 2 * event.number) ++wrong;
    newest = event.number;
    return true;
  };
  test::contend(
      [&] {
        const std::uint64_t number = pushed.load(std::memory_order_relaxed) + 1;
        (void)ring.push({number, 2 * number});  // dropped ones are under test
        pushed.store(number, std::memory_order_relaxed);
      },
      [&] { return take() && popped >= 20'000; });
  while (take()) {
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(popped + ring.dropped(), pushed.load(std::memory_order_relaxed));
}

// Wrong on purpose: marks the slot as full before it is. (Its slots are atomic so that
// ThreadSanitizer leaves the finding to the test.)
class RingThatPublishesEarly {
 public:
  bool push(std::uint64_t value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return false;
    head_.store(head + 1, std::memory_order_release);
    test::falter();
    slots_[head % kCapacity].store(value, std::memory_order_relaxed);
    return true;
  }
  bool pop(std::uint64_t& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail % kCapacity].load(std::memory_order_relaxed);
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  static constexpr std::size_t kCapacity = 64;
  std::atomic<std::size_t> head_{0};
  std::atomic<std::size_t> tail_{0};
  std::atomic<std::uint64_t> slots_[kCapacity]{};
};

// Wrong on purpose: overwrites what was not read yet.
class RingWithoutEnd {
 public:
  bool push(std::uint64_t value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    slots_[head % kCapacity].store(value, std::memory_order_relaxed);
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  bool pop(std::uint64_t& value) {
    if (tail_ == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail_++ % kCapacity].load(std::memory_order_relaxed);
    return true;
  }

 private:
  static constexpr std::size_t kCapacity = 64;
  std::atomic<std::size_t> head_{0};
  std::size_t tail_ = 0;
  std::atomic<std::uint64_t> slots_[kCapacity]{};
};

template <typename Ring>
bool is_caught(Ring& ring, std::uint64_t enough) {
  std::uint64_t pushed = 0;
  std::uint64_t expected = 0;
  bool caught = false;
  test::contend(
      [&] {
        if (ring.push(pushed)) ++pushed;
      },
      [&] {
        std::uint64_t value = 0;
        if (!ring.pop(value)) return false;
        caught = value != expected++;
        return caught || expected == enough;
      });
  return caught;
}

TEST(SpscRing, WouldBeCaughtIfItPublishedEarly) {
  RingThatPublishesEarly broken;
  EXPECT_TRUE(is_caught(broken, std::numeric_limits<std::uint64_t>::max()));
}

TEST(SpscRing, WouldBeCaughtIfItWroteOverWhatWasNotRead) {
  RingWithoutEnd broken;
  EXPECT_TRUE(is_caught(broken, std::numeric_limits<std::uint64_t>::max()));
}

TEST(SpscRing, IsNotCaught) {
  SpscRing<std::uint64_t, 64> ring;
  EXPECT_FALSE(is_caught(ring, 100'000));
}

}  // namespace
}  // namespace cargobay::rt
