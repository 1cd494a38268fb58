#include "gpio/pulse_player.hpp"

#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::gpio {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::Pair;

// Time that passes only during waits, with delays that the test sets.
class VirtualClock final : public PulseClock {
 public:
  TimePoint now() override { return TimePoint{time}; }
  bool wait_until(TimePoint deadline) override {
    const int wait = waits++;
    if (wait == ends_at) return false;
    time = std::max<std::chrono::nanoseconds>(time, deadline.time_since_epoch());
    if (wait == late_at) time += late_by;
    return true;
  }
  std::chrono::nanoseconds time{milliseconds{1000}};
  int waits = 0;
  int ends_at = -1;
  int late_at = -1;
  milliseconds late_by{0};
};

class RecordingPin final : public Output {
 public:
  explicit RecordingPin(const VirtualClock& clock) : clock_{clock} {}
  std::error_code set(Level level) override {
    if (std::cmp_equal(levels.size(), fails_at))
      return std::make_error_code(std::errc::no_such_device);
    levels.emplace_back(std::chrono::duration_cast<milliseconds>(clock_.time).count(), level);
    return {};
  }
  std::vector<std::pair<std::int64_t, Level>> levels;
  int fails_at = -1;

 private:
  const VirtualClock& clock_;
};

class PulsePlayer : public testing::Test {
 protected:
  PlayReport play_brc() { return play(*brc_pulses(), pin_, clock_, Level::high); }
  std::vector<milliseconds> lasted(const PlayReport& report) const {
    std::vector<milliseconds> widths;
    for (const PlayedPulse& pulse : report.pulses())
      widths.push_back(std::chrono::duration_cast<milliseconds>(pulse.lasted));
    return widths;
  }
  VirtualClock clock_;
  RecordingPin pin_{clock_};
};

TEST_F(PulsePlayer, SetsEachEdgeAtItsTimeAndReleases) {
  const PlayReport report = play_brc();
  EXPECT_TRUE(report.complete());
  EXPECT_THAT(pin_.levels,
              ElementsAre(Pair(1000, Level::low), Pair(1250, Level::high), Pair(1500, Level::low),
                          Pair(1750, Level::high), Pair(2000, Level::low), Pair(2250, Level::high),
                          Pair(2500, Level::high)));
  EXPECT_THAT(lasted(report), testing::Each(milliseconds{250}));
  EXPECT_EQ(report.count, 6U);
}

TEST_F(PulsePlayer, TellsTheWidthsItAchieved) {
  clock_.late_at = 2;
  clock_.late_by = milliseconds{40};
  const PlayReport report = play_brc();
  EXPECT_EQ(lasted(report)[2], milliseconds{290});
  EXPECT_EQ(lasted(report)[3], milliseconds{210}) << "the next edge keeps its deadline";
  EXPECT_EQ(pin_.levels[4], std::pair(std::int64_t{2000}, Level::low)) << "nothing adds up";
}

TEST_F(PulsePlayer, DoesNotMakeAPulseShortForAVeryLateEdge) {
  clock_.late_at = 1;
  clock_.late_by = milliseconds{240};
  const PlayReport report = play_brc();
  EXPECT_TRUE(report.complete());
  EXPECT_EQ(lasted(report)[1], milliseconds{490});
  EXPECT_EQ(lasted(report)[2], milliseconds{250});
}

TEST_F(PulsePlayer, ReleasesThePinWhereItIsEnded) {
  clock_.ends_at = 2;  // in the second low pulse
  const PlayReport report = play_brc();
  EXPECT_TRUE(report.interrupted);
  EXPECT_FALSE(report.complete());
  EXPECT_EQ(report.count, 2U);
  EXPECT_EQ(pin_.levels.back().second, Level::high);
  EXPECT_EQ(pin_.levels.size(), 4U);
}

TEST_F(PulsePlayer, TellsThatThePinFailed) {
  pin_.fails_at = 3;
  const PlayReport report = play_brc();
  EXPECT_EQ(report.line_error, std::errc::no_such_device);
  EXPECT_FALSE(report.complete());
  EXPECT_EQ(report.count, 3U);
}

TEST_F(PulsePlayer, LeavesThePowerToggleLow) {
  EXPECT_TRUE(play(power_toggle(), pin_, clock_, Level::low).complete());
  EXPECT_EQ(pin_.levels.back().second, Level::low);
}

TEST(MonotonicClock, WaitsUntilThenAndNotLess) {
  MonotonicClock clock;
  const auto deadline = clock.now() + milliseconds{2};
  EXPECT_TRUE(clock.wait_until(deadline));
  EXPECT_GE(clock.now(), deadline);
  EXPECT_TRUE(clock.wait_until(deadline - milliseconds{1})) << "in the past";
}

}  // namespace
}  // namespace cargobay::gpio
