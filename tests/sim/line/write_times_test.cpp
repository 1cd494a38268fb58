#include "hal/sim/line/write_times.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/random.hpp"

namespace cargobay::hal::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr rt::Duration kSpacing = microseconds{200};

rt::TimePoint at(rt::Duration since) { return rt::TimePoint{std::chrono::hours{1} + since}; }

// Looks every `period`, from 0 on, and delivers what was written `delay` before.
class Watch {
 public:
  Watch(const std::vector<rt::Duration>& writes, rt::Duration delay)
      : writes_{writes}, delay_{delay} {
    times_.look(at(rt::Duration{0}), at(rt::Duration{0}), false);
  }
  void look(rt::Duration now) {
    const bool written = seen_ < writes_.size() && writes_[seen_] <= now;
    while (seen_ < writes_.size() && writes_[seen_] <= now) ++seen_;
    times_.look(at(now), at(now), written);
    for (; read_ < writes_.size() && writes_[read_] + delay_ <= now; ++read_)
      if (times_.take()) ++spaced_;
  }
  std::size_t read() const { return read_; }
  std::size_t spaced() const { return spaced_; }

 private:
  std::vector<rt::Duration> writes_;
  rt::Duration delay_;
  WriteTimes times_{kSpacing};
  std::size_t seen_ = 0;
  std::size_t read_ = 0;
  std::size_t spaced_ = 0;
};

TEST(WriteTimes, BelieveEachByteThatIsSpacedHoweverSeldomTheyLookAndLateItComes) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random{seed};
    std::vector<rt::Duration> writes;
    rt::Duration time = microseconds{500};
    for (int i = 0; i < 400; ++i) {
      writes.push_back(time);
      time += kSpacing;
      if (random.uniform() < 0.3) time += microseconds{random.below(5000)};
    }
    Watch watch{writes, microseconds{random.below(40'000)}};
    const rt::Duration end = time + milliseconds{60};
    for (rt::Duration now{0}; now < end;) {
      now += microseconds{1 + random.below(random.uniform() < 0.1 ? 20'000 : 300)};
      watch.look(now);
    }
    ASSERT_EQ(watch.read(), writes.size()) << "seed " << seed;
    ASSERT_EQ(watch.spaced(), writes.size()) << "seed " << seed;
  }
}

TEST(WriteTimes, ExcuseNoneOfABurstBeyondTheFirst) {
  std::vector<rt::Duration> writes;
  for (int command = 1; command <= 20; ++command)
    writes.insert(writes.end(), 5, milliseconds{15} * command);
  for (const rt::Duration delay : {microseconds{0}, microseconds{30}, microseconds{8000}}) {
    Watch watch{writes, delay};
    for (rt::Duration now{0}; now < milliseconds{400}; now += microseconds{100}) watch.look(now);
    EXPECT_EQ(watch.read(), 100U);
    EXPECT_EQ(watch.spaced(), 20U) << delay.count();
  }
}

TEST(WriteTimes, ExcuseWhatFitsIntoTheTimeWithoutALook) {
  const std::vector<rt::Duration> writes(40, milliseconds{3});
  Watch watch{writes, rt::Duration{0}};
  watch.look(microseconds{2000});
  watch.look(microseconds{3100});  // 1.1 ms hold bytes at 0, 0.2, 0.4, 0.6, 0.8 and 1 ms
  EXPECT_EQ(watch.read(), 40U);
  EXPECT_EQ(watch.spaced(), 6U);
}

TEST(WriteTimes, ForgetWhatWasLeftOver) {
  std::vector<rt::Duration> writes{milliseconds{5}};
  writes.insert(writes.end(), 5, milliseconds{600});
  Watch watch{writes, rt::Duration{0}};
  watch.look(milliseconds{10});  // a long time without a look, and one byte in it
  for (rt::Duration now = milliseconds{10}; now < milliseconds{700}; now += microseconds{100})
    watch.look(now);
  EXPECT_EQ(watch.read(), 6U);
  EXPECT_EQ(watch.spaced(), 2U);
}

TEST(WriteTimes, HaveRoomForAWorkerThatIsVeryLate) {
  std::vector<rt::Duration> writes;
  for (int i = 1; i <= 1200; ++i) writes.push_back(kSpacing * i);
  Watch watch{writes, milliseconds{240}};
  for (rt::Duration now{0}; now < milliseconds{600}; now += microseconds{100}) watch.look(now);
  EXPECT_EQ(watch.read(), 1200U);
  EXPECT_EQ(watch.spaced(), 1200U);
}

}  // namespace
}  // namespace cargobay::hal::sim
