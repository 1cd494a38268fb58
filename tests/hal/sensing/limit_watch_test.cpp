#include "hal/sensing/limit_watch.hpp"

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

constexpr auto kSpeed = Limits{}.with(Limit::speed);
constexpr auto kAcceleration = Limits{}.with(Limit::acceleration);
constexpr rt::WheelSpeeds kWanted{500.0, 400.0};
constexpr rt::WheelSpeeds kGot{450.0, 360.0};

// The events of so many ticks.
int events(LimitWatch& watch, Limits limits, int ticks, std::optional<Event>& last) {
  int count = 0;
  for (int i = 0; i < ticks; ++i) {
    if (const auto event = watch.see(limits, kWanted, kGot)) {
      last = event;
      ++count;
    }
  }
  return count;
}

TEST(LimitWatch, ReportsALimitOfSpeedAtOnceAndOnce) {
  LimitWatch watch;
  std::optional<Event> event;
  EXPECT_EQ(events(watch, kSpeed, 1, event), 1);
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->what, EventKind::limit_began);
  EXPECT_EQ(event->limits, kSpeed);
  EXPECT_EQ(event->wanted, kWanted);
  EXPECT_EQ(event->got, kGot);
  EXPECT_EQ(events(watch, kSpeed, 1000, event), 0);
}

TEST(LimitWatch, ReportsTheEndOnceNothingWasLimitedForHalfASecond) {
  LimitWatch watch;
  std::optional<Event> event;
  events(watch, kSpeed, 1, event);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(events(watch, {}, LimitWatch::kFreeTicks - 1, event), 0);
    EXPECT_EQ(events(watch, kSpeed, 1, event), 0) << "it has not ended";
  }
  EXPECT_EQ(events(watch, {}, LimitWatch::kFreeTicks, event), 1);
  EXPECT_EQ(event->what, EventKind::limit_ended);
  EXPECT_EQ(events(watch, {}, 1000, event), 0);
  EXPECT_EQ(events(watch, kSpeed, 1, event), 1) << "and begins again";
}

TEST(LimitWatch, SaysNothingOfAccelerationThatIsOverWithinASecond) {
  LimitWatch watch;
  std::optional<Event> event;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(events(watch, kAcceleration, LimitWatch::kAccelerationTicks - 1, event), 0);
    EXPECT_EQ(events(watch, {}, 1, event), 0);
  }
  EXPECT_EQ(events(watch, kAcceleration, LimitWatch::kAccelerationTicks, event), 1);
  EXPECT_EQ(event->what, EventKind::limit_began);
  EXPECT_EQ(event->limits, kAcceleration);
}

TEST(LimitWatch, ReportsASecondLimitByItself) {
  LimitWatch watch;
  std::optional<Event> event;
  events(watch, kSpeed, 1, event);
  EXPECT_EQ(events(watch, kSpeed.with(Limit::acceleration), LimitWatch::kAccelerationTicks, event),
            1);
  EXPECT_EQ(event->limits, kAcceleration);
  EXPECT_EQ(events(watch, {}, LimitWatch::kFreeTicks, event), 1);
  EXPECT_EQ(event->limits, kSpeed.with(Limit::acceleration)) << "both have ended";
}

}  // namespace
}  // namespace cargobay::hal
