#include "hal/sensing/events.hpp"

#include <set>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

TEST(Events, HaveANameOfTheirOwnAndWords) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kEventKinds; ++i) {
    const auto what = static_cast<EventKind>(i);
    EXPECT_TRUE(names.insert(name(what)).second) << i << " is called as another is";
    EXPECT_FALSE(describe(Event{.what = what}).empty()) << name(what);
  }
}

TEST(Events, SayWhatTheyCarry) {
  EXPECT_EQ(payload(EventKind::mode_lost), Payload::mode);
  EXPECT_EQ(payload(EventKind::bump_began), Payload::bumps);
  EXPECT_EQ(payload(EventKind::charging_ended), Payload::battery);
  EXPECT_EQ(payload(EventKind::rearmed), Payload::nothing);
}

TEST(Events, PutTheirPayloadIntoWords) {
  EXPECT_EQ(describe(Event{.what = EventKind::bump_began, .bumps = Bumps{2}}),
            "the robot bumped into something on the left");
  EXPECT_EQ(describe(Event{.what = EventKind::frames_lost, .frames = 2}), "2 frames lost");
  EXPECT_THAT(
      describe(Event{.what = EventKind::mode_lost,
                     .mode = oi::Mode::passive,
                     .hazards = Hazards{}.with(Hazard::cliff_left)}),
      testing::AllOf(testing::HasSubstr("passive"), testing::HasSubstr("a cliff on the left")));
}

TEST(Events, NameWheelsAndWhatIsWrongWithThem) {
  Event event{.what = EventKind::counters_implausible,
              .wheels = oi::BitSet<Wheel>{}.with(Wheel::left),
              .finding = rt::WheelWatch::Finding::still,
              .wanted = {180.4, 200.0},
              .got = {0.0, 179.0}};
  EXPECT_EQ(
      describe(event),
      "the left wheel is driven but counts nothing: its counter is dead, or it is stuck (left "
      "and right: driven at 180 and 200 mm/s, counted 0 and 179)");
  event.wheels = event.wheels.with(Wheel::right);
  event.finding = rt::WheelWatch::Finding::jumps;
  EXPECT_EQ(describe(event),
            "both wheels say again and again that they went further than any robot can");
  EXPECT_THAT(describe(Event{.what = EventKind::wheel_stuck,
                             .wheels = oi::BitSet<Wheel>{}.with(Wheel::right),
                             .finding = rt::WheelWatch::Finding::still}),
              testing::StartsWith("the right wheel draws too much current and does not turn"));
  EXPECT_EQ(describe(Event{.what = EventKind::limit_began,
                           .limits = Limits{}.with(Limit::speed),
                           .wanted = {480.0, 480.0},
                           .got = {443.0, 443.0}}),
            "the wheels cannot turn as fast as asked for: 443 and 443 mm/s instead of 480 and 480");
  EXPECT_EQ(payload(EventKind::wheel_stuck), Payload::wheels);
  EXPECT_EQ(payload(EventKind::limit_ended), Payload::limits);
}

}  // namespace
}  // namespace cargobay::hal
