#include "hal/cycle/silence.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;
using Due = Silence::Due;

constexpr rt::TimePoint moment(rt::Duration time) { return rt::TimePoint{time}; }
constexpr Silence::Limits kSilenceLimits{.tick = 15ms, .stop_after = 150ms, .link_timeout = 1s};

// What was due, at each deadline from the last frame (at 0) until `end`.
struct Dues {
  int stops = 0;
  rt::Duration stop_at{};
  rt::Duration lost_at{};
};
Dues until(Silence& silence, rt::Duration end) {
  Dues dues;
  while (silence.deadline() < moment(end)) {
    const rt::TimePoint now = silence.deadline();
    const Due due = silence.deadline_passed(now, moment(0ms));
    if (due == Due::stop) {
      ++dues.stops;
      dues.stop_at = now.time_since_epoch();
    }
    if (due == Due::link_lost) {
      dues.lost_at = now.time_since_epoch();
      break;
    }
  }
  return dues;
}

TEST(Silence, StopsOnceAndThenGivesTheLinkUp) {
  Silence silence{kSilenceLimits};
  (void)silence.end(moment(20ms));
  const Dues dues = until(silence, 2s);
  EXPECT_EQ(dues.stops, 1);
  EXPECT_EQ(dues.stop_at, 155ms) << "the first deadline of a tick past 150 ms";
  EXPECT_EQ(dues.lost_at, 1010ms);
}

TEST(Silence, BeginsWithTheTimeUntilTheStop) {
  Silence silence{kSilenceLimits};
  silence.begin(moment(0ms));
  EXPECT_EQ(silence.deadline(), moment(150ms));
}

TEST(Silence, ThatWasAnnouncedLosesNoLinkAndStopsAllTheSame) {
  Silence silence{kSilenceLimits};
  (void)silence.end(moment(20ms));
  silence.announce(3s);
  EXPECT_EQ(until(silence, 500ms).stops, 1) << "not taken up yet";
  silence.take_up_announced(moment(500ms));
  EXPECT_EQ(until(silence, 3490ms).lost_at, 0ms);
  EXPECT_GE(until(silence, 5s).lost_at, 3500ms);
}

TEST(Silence, SaysAtItsEndWhetherTheWheelsWereStopped) {
  Silence silence{kSilenceLimits};
  EXPECT_FALSE(silence.end(moment(20ms)));
  (void)until(silence, 400ms);
  silence.owe_stop(true);
  EXPECT_TRUE(silence.end(moment(420ms)));
  EXPECT_FALSE(silence.owes_stop());
  EXPECT_FALSE(silence.end(moment(440ms)));
}

}  // namespace
}  // namespace cargobay::hal
