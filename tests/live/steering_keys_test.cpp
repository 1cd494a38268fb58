#include "hal/cli/live/steering_keys.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::cli {
namespace {

using enum SteeringKey;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr rt::TimePoint kThen{std::chrono::seconds{100}};

std::vector<SteeringKey> keys(KeyDecoder& decoder, std::string_view bytes) {
  std::vector<SteeringKey> seen;
  decoder.take(bytes, [&](SteeringKey key) { seen.push_back(key); });
  return seen;
}

TEST(KeyDecoder, KnowsLettersAndBothFormsOfArrows) {
  KeyDecoder decoder;
  EXPECT_THAT(keys(decoder, "wasd"), ElementsAre(forward, left, back, right));
  EXPECT_THAT(keys(decoder, "\x1b[A\x1b[B\x1b[C\x1b[D"), ElementsAre(forward, back, right, left));
  EXPECT_THAT(keys(decoder, "\x1bOA\x1bOD"), ElementsAre(forward, left));
  EXPECT_THAT(keys(decoder, "\x1b[1;2A"), ElementsAre(forward)) << "with Shift";
  EXPECT_THAT(keys(decoder, "x\x1b[5~w"), ElementsAre(forward)) << "page up is nothing";
  EXPECT_THAT(keys(decoder, " +-=trq"),
              ElementsAre(stop, faster, slower, faster, take, rearm, quit));
}

TEST(KeyDecoder, TakesAnArrowThatComesInPieces) {
  KeyDecoder decoder;
  EXPECT_THAT(keys(decoder, "\x1b"), ElementsAre(stop)) << "Escape, as far as it can know";
  EXPECT_THAT(keys(decoder, "["), IsEmpty());
  EXPECT_THAT(keys(decoder, "A"), ElementsAre(forward)) << "not the letter, which is left";
  EXPECT_THAT(keys(decoder, "A"), ElementsAre(left));
}

TEST(HeldKeys, CountForTheirTimeAndOnWhileTheyRepeat) {
  HeldKeys held;
  held.press(forward, kThen);
  EXPECT_EQ(held.wish(kThen), (Wish{.forward = 1.0}));
  EXPECT_EQ(held.wish(kThen + HeldKeys::kCounts - rt::Duration{1}), (Wish{.forward = 1.0}));
  EXPECT_EQ(held.wish(kThen + HeldKeys::kCounts), Wish{});
  held.press(forward, kThen + HeldKeys::kCounts);
  EXPECT_EQ(held.wish(kThen + HeldKeys::kCounts * 2 - rt::Duration{1}), (Wish{.forward = 1.0}));
}

TEST(HeldKeys, JoinDirectionsAndObeyTheLatestOfTwoThatContradict) {
  HeldKeys held;
  held.press(forward, kThen);
  held.press(left, kThen);
  EXPECT_EQ(held.wish(kThen), (Wish{.forward = 1.0, .turn = 1.0}));
  held.press(back, kThen);
  EXPECT_EQ(held.wish(kThen), (Wish{.forward = -1.0, .turn = 1.0}));
  held.press(stop, kThen);
  EXPECT_EQ(held.wish(kThen), Wish{});
}

TEST(StickAfterStop, CountsAgainOnceItWasLetGo) {
  StickAfterStop stick;
  const Wish ahead{.forward = 1.0};
  EXPECT_EQ(stick.of(ahead), ahead);
  stick.stop();
  EXPECT_EQ(stick.of(ahead), Wish{});
  EXPECT_EQ(stick.of({.turn = 1.0}), Wish{}) << "moved, but not let go";
  EXPECT_EQ(stick.of({}), Wish{});
  EXPECT_EQ(stick.of(ahead), ahead);
}

TEST(Wish, NeverAsksAWheelForMoreThanTheSpeed) {
  for (const double forward : {-1.0, -0.4, 0.0, 0.7, 1.0}) {
    for (const double turn : {-1.0, -0.2, 0.0, 0.5, 1.0}) {
      const rt::WheelSpeeds speeds = speeds_for({.forward = forward, .turn = turn}, 300.0);
      EXPECT_LE(std::abs(speeds.left_mm_s), 300.0);
      EXPECT_LE(std::abs(speeds.right_mm_s), 300.0);
      EXPECT_EQ(turn > 0.0, speeds.right_mm_s > speeds.left_mm_s);
    }
  }
  EXPECT_EQ(speeds_for({.forward = 1.0}, 300.0), (rt::WheelSpeeds{300.0, 300.0}));
  EXPECT_EQ(speeds_for({.turn = 1.0}, 300.0), (rt::WheelSpeeds{-150.0, 150.0}));
  EXPECT_EQ(speeds_for({.forward = 1.0, .turn = 1.0}, 300.0), (rt::WheelSpeeds{100.0, 300.0}));
}

}  // namespace
}  // namespace cargobay::cli
