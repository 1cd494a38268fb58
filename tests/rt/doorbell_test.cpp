#include "rt/doorbell.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <climits>
#include <thread>

#include <gtest/gtest.h>

#include "tests/rt/stress.hpp"

namespace cargobay::rt {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

TEST(Doorbell, IsHeardByWhoComesLater) {
  Doorbell bell;
  const std::uint32_t seen = bell.rings();
  bell.ring();
  EXPECT_TRUE(bell.wait(seen, Clock::now()));
  EXPECT_EQ(bell.rings(), seen + 1);
}

TEST(Doorbell, GivesUpAtTheDeadline) {
  Doorbell bell;
  EXPECT_FALSE(bell.wait(bell.rings(), Clock::now() + 1ms));
}

// Like the real one, but it looks for waiters before it rings: one that comes in between is not
// woken.
class BrokenDoorbell {
 public:
  std::uint32_t rings() const { return rings_.load(); }
  void ring() {
    const bool awaited = waiting_.load() != 0;
    test::falter();
    rings_.fetch_add(1);
    if (awaited) syscall(SYS_futex, &rings_, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
  }
  bool wait(std::uint32_t seen, TimePoint deadline) {
    waiting_.fetch_add(1);
    bool woken = true;
    while (rings_.load() == seen && woken) {
      const timespec until = as_timespec(deadline.time_since_epoch());
      syscall(SYS_futex, &rings_, FUTEX_WAIT_BITSET_PRIVATE, seen, &until, nullptr,
              FUTEX_BITSET_MATCH_ANY);
      woken = Clock::now() < deadline;
    }
    waiting_.fetch_sub(1);
    return woken;
  }

 private:
  std::atomic<std::uint32_t> rings_{0};
  std::atomic<std::uint32_t> waiting_{0};
};

// One rings as soon as the other has answered; a thread that sleeps although it has rung sleeps for
// a second. Returns whether that happened within `rounds` rounds.
template <typename Bell>
bool oversleeps(int rounds) {
  Bell bell;
  std::atomic<std::uint32_t> answered{0};
  std::atomic<bool> over{false};
  const test::Apart apart;
  std::thread ringer{[&] {
    apart.move_on();
    for (std::uint32_t round = 0; !over.load(); ++round) {
      while (answered.load() != round && !over.load()) std::this_thread::yield();
      bell.ring();
    }
  }};
  bool slept = false;
  for (int i = 0; i < rounds && !slept; ++i) {
    const std::uint32_t seen = static_cast<std::uint32_t>(i);
    const TimePoint late = Clock::now() + 1s;
    (void)bell.wait(seen, late);
    slept = Clock::now() >= late;
    answered.store(seen + 1);
  }
  over.store(true);
  ringer.join();
  return slept;
}

TEST(Doorbell, LetsNobodyOversleep) { EXPECT_FALSE(oversleeps<Doorbell>(20'000)); }

TEST(Doorbell, ItsBrokenTwinLetsSomebodyOversleep) {
  EXPECT_TRUE(oversleeps<BrokenDoorbell>(1'000'000)) << "the test would not see a broken one";
}

}  // namespace
}  // namespace cargobay::rt
