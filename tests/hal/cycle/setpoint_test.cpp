#include "hal/cycle/setpoint.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;
using Age = Setpoint::Age;

constexpr rt::TimePoint at(rt::Duration time) { return rt::TimePoint{time}; }

TEST(Setpoint, IsLapsedUntilTheFirst) {
  Setpoint setpoint{500ms};
  EXPECT_EQ(setpoint.see(at(0ms)), Age::lapsed);
}

TEST(Setpoint, CountsFromTheTickThatSeesIt) {
  Setpoint setpoint{500ms};
  ASSERT_TRUE(setpoint.put({200.0, -100.0}));
  EXPECT_EQ(setpoint.see(at(1000ms)), Age::alive);
  EXPECT_EQ(setpoint.speeds(), (rt::WheelSpeeds{200.0, -100.0}));
  EXPECT_EQ(setpoint.see(at(1500ms)), Age::alive);
  EXPECT_EQ(setpoint.see(at(1501ms)), Age::lapses);
  EXPECT_EQ(setpoint.see(at(1502ms)), Age::lapsed) << "reported once";
}

TEST(Setpoint, LivesAgainWhenItIsSetAgainToTheSame) {
  Setpoint setpoint{500ms};
  ASSERT_TRUE(setpoint.put({200.0, 200.0}));
  (void)setpoint.see(at(0ms));
  ASSERT_TRUE(setpoint.put({200.0, 200.0}));
  EXPECT_EQ(setpoint.see(at(600ms)), Age::alive);
  EXPECT_EQ(setpoint.see(at(1100ms)), Age::alive);
  EXPECT_EQ(setpoint.see(at(1101ms)), Age::lapses);
}

TEST(Setpoint, ThatWasDroppedStaysSo) {
  Setpoint setpoint{500ms};
  ASSERT_TRUE(setpoint.put({200.0, 200.0}));
  setpoint.drop();
  EXPECT_EQ(setpoint.see(at(0ms)), Age::lapsed);
  ASSERT_TRUE(setpoint.put({100.0, 100.0}));
  EXPECT_EQ(setpoint.see(at(15ms)), Age::alive);
}

TEST(Setpoint, KeepsTheFormerWhereTheNextIsRefused) {
  Setpoint setpoint{500ms};
  ASSERT_TRUE(setpoint.put({200.0, 200.0}));
  EXPECT_FALSE(setpoint.put({600.0, 0.0}));
  EXPECT_EQ(setpoint.see(at(0ms)), Age::alive);
  EXPECT_EQ(setpoint.speeds(), (rt::WheelSpeeds{200.0, 200.0}));
}

TEST(Setpoint, ThatWasRevokedNoLongerCountsAndIsNotReported) {
  Setpoint setpoint{500ms};
  ASSERT_TRUE(setpoint.put({200.0, 200.0}));
  EXPECT_EQ(setpoint.see(at(0ms)), Age::alive);
  setpoint.revoke();
  EXPECT_EQ(setpoint.see(at(15ms)), Age::lapsed);
  EXPECT_EQ(setpoint.see(at(600ms)), Age::lapsed) << "it does not lapse again";
}

TEST(Setpoint, CountsIfItWasPutAfterTheRevocation) {
  Setpoint setpoint{500ms};
  ASSERT_TRUE(setpoint.put({200.0, 200.0}));
  setpoint.revoke();
  ASSERT_TRUE(setpoint.put({100.0, 100.0}));  // before the tick that would have seen it
  EXPECT_EQ(setpoint.see(at(15ms)), Age::alive);
  EXPECT_EQ(setpoint.speeds(), (rt::WheelSpeeds{100.0, 100.0}));
}

// The serial number has 24 bits, and leaves out 0.
TEST(Setpoint, CountsWhereItHasTheNumberOfOneThatWasRevoked) {
  for (const bool superseded : {false, true}) {
    Setpoint setpoint{500ms};
    ASSERT_TRUE(setpoint.put({200.0, 200.0}));
    setpoint.revoke();
    if (superseded) {
      ASSERT_TRUE(setpoint.put({150.0, 150.0}));
    }
    (void)setpoint.see(at(0ms));
    ASSERT_TRUE(setpoint.put({100.0, 100.0}));
    EXPECT_EQ(setpoint.see(at(15ms)), Age::alive);
    const int left = (1 << 24) - (superseded ? 3 : 2);
    for (int i = 0; i < left; ++i) ASSERT_TRUE(setpoint.put({100.0, 100.0}));
    EXPECT_EQ(setpoint.see(at(30ms)), Age::alive);
  }
}

}  // namespace
}  // namespace cargobay::hal
