#include "hal/cycle/user_control.hpp"

#include <chrono>
#include <limits>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;

using Refusal = UserControl::Refusal;

constexpr UserControl::Limits kControlLimits{.tick = 15ms, .budget = 2ms, .overruns_allowed = 2};

// Returns what it is told to, and records the time that it was given.
struct Program {
  ControlAnswer answer{rt::WheelSpeeds{}};
  double seconds = -1.0;
  static ControlAnswer control(void* context, const CycleState&, double seconds)
      CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Program*>(context);
    self.seconds = seconds;
    return self.answer;
  }
};

class UserControlTest : public testing::Test {
 protected:
  UserControlTest() { control_.set({.function = &Program::control, .context = &program_}); }
  Program program_{};
  UserControl control_{kControlLimits};
};

TEST_F(UserControlTest, IsGivenRobotTime) {
  program_.answer = rt::WheelSpeeds{100.0, 200.0};
  const ControlAnswer answer = control_.ask({.tick = 200});
  EXPECT_DOUBLE_EQ(program_.seconds, 3.0);
  EXPECT_EQ(answer.speeds(), (rt::WheelSpeeds{100.0, 200.0}));
  EXPECT_EQ(control_.refusal(), Refusal::none);
}

TEST_F(UserControlTest, RefusesWhatNoRobotFollowsAndReportsTheFirstOfARow) {
  for (const double speed : {500.5, -500.5, std::numeric_limits<double>::quiet_NaN()}) {
    program_.answer = rt::WheelSpeeds{0.0, speed};
    EXPECT_EQ(control_.ask({}).kind(), ControlAnswer::Kind::stand);
    EXPECT_EQ(control_.refusal(), Refusal::first) << speed;
    EXPECT_EQ(control_.ask({}).kind(), ControlAnswer::Kind::stand);
    EXPECT_EQ(control_.refusal(), Refusal::another) << speed;
    program_.answer = rt::WheelSpeeds{500.0, -500.0};
    EXPECT_EQ(control_.ask({}).speeds(), (rt::WheelSpeeds{500.0, -500.0}));
    EXPECT_EQ(control_.refusal(), Refusal::none);
  }
}

TEST_F(UserControlTest, PassesOnWhatIsNoSpeed) {
  using Kind = ControlAnswer::Kind;
  for (const Kind kind : {Kind::setpoint, Kind::stand, Kind::finish, Kind::fail}) {
    program_.answer = kind;
    EXPECT_EQ(control_.ask({}).kind(), kind);
    EXPECT_EQ(control_.refusal(), Refusal::none);
  }
}

TEST_F(UserControlTest, CountsOverrunsInARow) {
  EXPECT_FALSE(control_.over_budget(2ms));
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(control_.over_budget(2ms + 1ns));
  EXPECT_FALSE(control_.too_many_overruns());
  EXPECT_FALSE(control_.over_budget(1ms)) << "which ends the row";
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(control_.over_budget(3ms));
  EXPECT_FALSE(control_.too_many_overruns()) << "those before the break do not count";
  EXPECT_TRUE(control_.over_budget(3ms));
  EXPECT_TRUE(control_.too_many_overruns());
}

TEST(UserControl, ThatIsNotSetHasNoBudget) {
  UserControl control{kControlLimits};
  EXPECT_FALSE(control.is_set());
  EXPECT_FALSE(control.over_budget(1s));
}

}  // namespace
}  // namespace cargobay::hal
