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

}  // namespace
}  // namespace cargobay::hal
