#include "hal/sim/drive_train/encoder.hpp"

#include <gtest/gtest.h>

namespace cargobay::hal::sim {
namespace {

TEST(Encoder, MissesThatShareOfItsSteps) {
  Encoder encoder{10.0, CounterSign::commanded, 0.3};
  encoder.roll(0.0, 100.0, 1);
  EXPECT_EQ(encoder.counts(), 700);
  EXPECT_EQ(encoder.edges(), 700);
}

TEST(Encoder, MissesTheSameHoweverTheWayIsCut) {
  Encoder whole{7.8324, CounterSign::commanded, 0.37};
  Encoder cut{7.8324, CounterSign::commanded, 0.37};
  whole.roll(0.0, 200.0, -1);
  for (int i = 0; i < 1000; ++i) cut.roll(0.2 * i, 0.2 * (i + 1), -1);
  EXPECT_EQ(whole.counts(), cut.counts());
  EXPECT_EQ(whole.counts(), -986);  // floor(1566 * 0.63)
}

TEST(Encoder, SeesNothingWhenItIsDead) {
  Encoder encoder{7.8324, CounterSign::commanded, 0.0};
  encoder.roll(0.0, 100.0, 1);
  const std::int64_t before = encoder.counts();
  encoder.set(7.8324, CounterSign::commanded, 1.0);
  encoder.roll(100.0, 300.0, 1);
  EXPECT_EQ(encoder.counts(), before);
  encoder.set(7.8324, CounterSign::commanded, 0.0);
  encoder.roll(300.0, 310.0, 1);
  EXPECT_NEAR(static_cast<double>(encoder.counts() - before), 78.3, 1.0);
}

TEST(Encoder, TakesTheSignOfTheCommandUnlessItSeesTheDirection) {
  Encoder one_channel{10.0, CounterSign::commanded, 0.0};
  Encoder quadrature{10.0, CounterSign::true_one, 0.0};
  for (Encoder* const encoder : {&one_channel, &quadrature}) {
    encoder->roll(0.0, 20.0, 1);
    encoder->roll(20.0, 25.0, -1);  // still rolling forward
    encoder->roll(25.0, 10.0, -1);
  }
  EXPECT_EQ(one_channel.counts(), 200 - 50 - 150);
  EXPECT_EQ(one_channel.edges(), 400);
  EXPECT_EQ(quadrature.counts(), 100);
  EXPECT_EQ(quadrature.edges(), 100);
}

}  // namespace
}  // namespace cargobay::hal::sim
