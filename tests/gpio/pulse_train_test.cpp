#include "gpio/pulse_train.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::gpio {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

TEST(BrcPulses, AreThreeLowPulsesThatEndReleased) {
  const auto train = brc_pulses();
  ASSERT_TRUE(train.has_value());
  const Pulse low{Level::low, milliseconds{250}};
  const Pulse high{Level::high, milliseconds{250}};
  EXPECT_THAT(train->pulses(), ElementsAre(low, high, low, high, low, high));
  EXPECT_EQ(train->duration(), milliseconds{1500});
}

TEST(BrcPulses, TakeTheWidthsTheManualAllows) {
  EXPECT_TRUE(brc_pulses(milliseconds{50}, milliseconds{50}).has_value());
  EXPECT_TRUE(brc_pulses(milliseconds{500}, milliseconds{500}).has_value());
  EXPECT_EQ(brc_pulses(milliseconds{100}, milliseconds{60})->duration(), milliseconds{480});
}

TEST(BrcPulses, RefuseAllOthers) {
  EXPECT_FALSE(brc_pulses(milliseconds{49}, milliseconds{250}).has_value());
  EXPECT_FALSE(brc_pulses(milliseconds{501}, milliseconds{250}).has_value());
  EXPECT_FALSE(brc_pulses(milliseconds{250}, milliseconds{49}).has_value());
  EXPECT_FALSE(brc_pulses(milliseconds{250}, milliseconds{501}).has_value());
  EXPECT_FALSE(brc_pulses(milliseconds{-250}, milliseconds{250}).has_value());
}

TEST(PowerToggle, RisesOnceAndEndsLow) {
  const PulseTrain train = power_toggle();
  int rises = 0;
  Level before = Level::low;
  for (const Pulse& pulse : train.pulses()) {
    if (before == Level::low && pulse.level == Level::high) ++rises;
    before = pulse.level;
  }
  EXPECT_EQ(rises, 1);
  EXPECT_EQ(before, Level::low);
  EXPECT_EQ(train.duration(), milliseconds{600});
}

}  // namespace
}  // namespace cargobay::gpio
