#include "hal/sensing/hearing_watch.hpp"

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using enum FrameList;

TEST(HearingWatch, IsContentWithARobotThatDoesAsItIsTold) {
  HearingWatch watch{reading};
  for (int i = 0; i < 5; ++i) watch.see(reading);
  watch.told(hazards);
  watch.see(reading);  // sent before the command came
  EXPECT_FALSE(watch.misheard());
  watch.see(hazards);
  watch.told(reading);
  watch.see(reading);
  for (int i = 0; i < 10; ++i) watch.see(reading);
  EXPECT_FALSE(watch.misheard());
  EXPECT_FALSE(watch.deaf());
}

TEST(HearingWatch, MissesAListThatDoesNotComeWithinItsPatience) {
  HearingWatch watch{reading};
  watch.told(hazards);
  for (int i = 0; i < HearingWatch::kPatience; ++i) {
    watch.see(reading);
    EXPECT_FALSE(watch.deaf()) << i;
  }
  watch.see(reading);
  EXPECT_TRUE(watch.deaf());
}

// Requested for one tick only: both lists that came since had been requested.
TEST(HearingWatch, MissesAListThatWasTakenBackAtOnce) {
  HearingWatch watch{hazards};
  watch.told(reading);
  watch.see(hazards);
  watch.told(hazards);
  for (int i = 0; i < HearingWatch::kPatience; ++i) watch.see(hazards);
  EXPECT_TRUE(watch.deaf());
}

TEST(HearingWatch, HoldsNoLostFrameAgainstTheRobot) {
  HearingWatch watch{hazards};
  watch.told(reading);
  watch.missed();
  watch.told(hazards);
  for (int i = 0; i < 10; ++i) watch.see(hazards);
  EXPECT_FALSE(watch.deaf());
}

TEST(HearingWatch, TakesTwoStrangeFramesForDeafnessAndOneForChance) {
  HearingWatch watch{reading};
  watch.see(std::nullopt);
  EXPECT_TRUE(watch.misheard());
  EXPECT_FALSE(watch.deaf());
  watch.see(battery);
  EXPECT_TRUE(watch.deaf());
  watch.see(reading);
  EXPECT_FALSE(watch.misheard());
  EXPECT_FALSE(watch.deaf());
}

TEST(HearingWatch, BelievesADeafRobotOnlyWhatItDoesNotStreamAlready) {
  HearingWatch watch{reading};
  watch.told(hazards);
  for (int i = 0; i <= HearingWatch::kPatience; ++i) watch.see(reading);
  ASSERT_TRUE(watch.deaf());
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(watch.probe(), hazards);
    watch.told(watch.probe());
    watch.see(reading);
    EXPECT_TRUE(watch.deaf());
  }
  watch.told(watch.probe());
  watch.see(hazards);
  EXPECT_FALSE(watch.deaf());
}

}  // namespace
}  // namespace cargobay::hal
