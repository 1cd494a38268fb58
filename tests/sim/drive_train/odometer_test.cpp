#include "hal/sim/drive_train/odometer.hpp"

#include <gtest/gtest.h>

namespace cargobay::hal::sim {
namespace {

Parameters with(Remainder remainder) {
  Parameters parameters;
  parameters.remainder = remainder;
  parameters.wheels.counts_per_mm = 4.0;  // a quarter of a millimetre a count
  return parameters;
}

TEST(Odometer, CarriesWhatAReadLeavesBehind) {
  Odometer odometer{with(Remainder::carried)};
  std::int32_t sum = 0;
  for (std::int64_t counts = 3; counts <= 300; counts += 3) {  // 0.75 mm a read
    odometer.latch(counts, counts);
    sum += odometer.take_distance().value;
  }
  EXPECT_EQ(sum, 75);
}

TEST(Odometer, LosesWhatAReadLeavesBehind) {
  Odometer odometer{with(Remainder::lost)};
  std::int32_t sum = 0;
  for (std::int64_t counts = 7; counts <= 700; counts += 7) {  // 1.75 mm a read
    odometer.latch(counts, counts);
    sum += odometer.take_distance().value;
  }
  EXPECT_EQ(sum, 100);
}

TEST(Odometer, TruncatesTowardZero) {
  Odometer odometer{with(Remainder::lost)};
  odometer.latch(-7, -7);
  EXPECT_EQ(odometer.take_distance().value, -1);
  odometer.latch(-10, -10);
  EXPECT_EQ(odometer.take_distance().value, 0);
}

TEST(Odometer, ReadsDistanceAndAngleApart) {
  Odometer odometer{with(Remainder::carried)};
  odometer.latch(-400, 440);  // 10 mm ahead, 210 mm apart
  EXPECT_EQ(odometer.take_angle().value, 46);
  EXPECT_EQ(odometer.take_distance().value, 5);
  EXPECT_EQ(odometer.take_angle().value, 0);
  EXPECT_EQ(odometer.take_distance().value, 0);
}

TEST(Odometer, StopsAtTheEndsOfSixteenBits) {
  Odometer odometer{with(Remainder::carried)};
  odometer.latch(200'000, 200'000);
  EXPECT_EQ(odometer.take_distance().value, 32767);
  EXPECT_EQ(odometer.take_distance().value, 0);
  odometer.latch(-200'000, -200'000);
  EXPECT_EQ(odometer.take_distance().value, -32768);
}

}  // namespace
}  // namespace cargobay::hal::sim
