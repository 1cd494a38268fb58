#include "rt/axis_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

constexpr double kLag = 0.100;
const AxisFilter::Response kResponse = AxisFilter::response(kLag, 0.015);

AxisFilter::Doubt of_speed(double mm_s) { return {.speed_mm_s = mm_s}; }
// What a gain that may be wrong by so much does to the speed in one tick.
AxisFilter::Doubt of_gain(double share, double driven_mm_s) {
  return of_speed(kResponse.speed_by_input * share * driven_mm_s);
}
AxisFilter::Doubt of_position(double mm) { return {.position_mm = mm}; }

// An axis that follows its drive with a lag, and its counter.
class Axis {
 public:
  Axis(double step_mm, Remainder remainder) : step_mm_{step_mm}, remainder_{remainder} {}

  void tick(double driven_mm_s) {
    const double decay = std::exp(-0.015 / kLag);
    position_mm_ += driven_mm_s * 0.015 + (speed_mm_s - driven_mm_s) * kLag * (1.0 - decay);
    speed_mm_s = driven_mm_s + (speed_mm_s - driven_mm_s) * decay;
  }
  int read() {
    const double whole = std::trunc(position_mm_ / step_mm_);
    position_mm_ = remainder_ == Remainder::carried ? position_mm_ - whole * step_mm_ : 0.0;
    return static_cast<int>(whole);
  }

  double speed_mm_s = 0.0;

 private:
  double step_mm_;
  Remainder remainder_;
  double position_mm_ = 0.0;
};

struct Route {
  double command_mm_s = 200.0;
  double gain = 0.92;
  double told_gain = 0.91;
  double disturbance_lag_s = 0.200;
  double true_step_mm = 1.0;
  double told_step_mm = 1.0;
  Remainder remainder = Remainder::carried;
  int read_every = 1;
};

struct Outcome {
  double rmse_mm_s = 0.0;  // from 1 s on
  double disturbance_mm_s = 0.0;
};

// Starts, reverses after 3 s, and goes on for another 3 s.
Outcome follow(const Route& run) {
  Axis axis{run.true_step_mm, run.remainder};
  AxisFilter filter{{.step_mm = run.told_step_mm, .disturbance_lag_s = run.disturbance_lag_s}};
  double squares = 0.0;
  int count = 0;
  constexpr int kTicks = 400;
  for (int tick = 1; tick <= kTicks; ++tick) {
    const double command_mm_s = tick <= kTicks / 2 ? run.command_mm_s : -0.5 * run.command_mm_s;
    axis.tick(run.gain * command_mm_s);
    const double error = std::abs(run.told_gain - run.gain);
    filter.predict(run.told_gain * command_mm_s, kResponse, of_gain(error, command_mm_s));
    if (tick % run.read_every == 0) filter.read(axis.read(), run.remainder);
    if (tick * 0.015 < 1.0) continue;
    squares += std::pow(filter.speed_mm_s() - axis.speed_mm_s, 2);
    ++count;
  }
  return {.rmse_mm_s = std::sqrt(squares / count), .disturbance_mm_s = filter.disturbance_mm_s()};
}

// Against the differential equation itself, in many small steps.
TEST(AxisFilter, AnswersATickAsTheLagSays) {
  for (const double lag_s : {0.020, 0.100, 0.500}) {
    const auto response = AxisFilter::response(lag_s, 0.015);
    for (const bool driven : {false, true}) {
      constexpr int kParts = 100'000;
      double speed = driven ? 0.0 : 1.0;
      double position = 0.0;
      for (int part = 0; part < kParts; ++part) {
        const double rate = ((driven ? 1.0 : 0.0) - speed) / lag_s;
        position += (speed + rate * 0.015 / kParts / 2.0) * 0.015 / kParts;
        speed += rate * 0.015 / kParts;
      }
      EXPECT_NEAR(driven ? response.speed_by_input : response.speed_by_speed, speed, 1e-5);
      EXPECT_NEAR(driven ? response.position_by_input : response.position_by_speed, position, 1e-6);
    }
  }
}

// x = F x + G u, P = F P F' + Q as in textbooks, compared with what is written out in the filter.
TEST(AxisFilter, PredictsAsTheMatricesSay) {
  const AxisFilter::Parameters parameters{.step_mm = 1.5};
  AxisFilter filter{parameters};
  const double decay = std::exp(-0.015 / kLag);
  const double travel = kLag * (1.0 - decay);
  Eigen::Matrix3d moving;
  const double keep = std::exp(-0.015 / parameters.disturbance_lag_s);
  moving << 1.0, travel, 0.015 - travel, 0.0, decay, 1.0 - decay, 0.0, 0.0, keep;
  Eigen::Matrix3d coasting = moving;
  coasting.topRightCorner<2, 1>().setZero();
  const Eigen::Vector3d input{0.015 - travel, 1.0 - decay, 0.0};
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d p = Eigen::Vector3d{1.5 * 1.5 / 3.0, 0.0, 1.0}.asDiagonal();
  std::mt19937 random{7};
  std::uniform_real_distribution<double> uniform{0.0, 1.0};
  for (int i = 0; i < 500; ++i) {
    const bool coasts = uniform(random) < 0.2;
    const double command = 400.0 * uniform(random) - 200.0;
    const AxisFilter::Doubt doubt{3.0 * uniform(random), uniform(random)};
    const Eigen::Matrix3d& f = coasts ? coasting : moving;
    x = (f * x).eval();
    if (!coasts) x += input * command;
    p = (f * p * f.transpose()).eval();
    const double noise = coasts ? 0.0 : parameters.disturbance_noise_mm_s;
    const double speed_noise = parameters.speed_noise_mm_s;
    p.diagonal() += Eigen::Vector3d{doubt.position_mm * doubt.position_mm,
                                    speed_noise * speed_noise + doubt.speed_mm_s * doubt.speed_mm_s,
                                    noise * noise};
    if (coasts) {
      filter.coast(kResponse, doubt);
    } else {
      filter.predict(command, kResponse, doubt);
    }
    ASSERT_NEAR(filter.disturbance_mm_s(), x[2], 1e-9);
    ASSERT_NEAR(filter.travel_mm(), x[0], 1e-9 * (1.0 + std::abs(x[0]))) << i;
    ASSERT_NEAR(filter.speed_mm_s(), x[1], 1e-9 * (1.0 + std::abs(x[1]))) << i;
    ASSERT_NEAR(filter.unread_variance(), p(0, 0), 1e-9 * p(0, 0)) << i;
    ASSERT_NEAR(filter.speed_variance(), p(1, 1), 1e-9 * p(1, 1)) << i;
  }
}

TEST(AxisFilter, FollowsAKnownTrajectory) {
  for (const double command_mm_s : {40.0, 117.0, 200.0, 333.0, 480.0}) {
    EXPECT_LT(follow({.command_mm_s = command_mm_s}).rmse_mm_s, 2.0) << command_mm_s;
  }
}

TEST(AxisFilter, FollowsACounterThatLosesTheRemainder) {
  for (const double command_mm_s : {40.0, 117.0, 200.0, 333.0, 480.0}) {
    const Route run{.command_mm_s = command_mm_s, .remainder = Remainder::lost, .read_every = 10};
    EXPECT_LT(follow(run).rmse_mm_s, 6.0) << command_mm_s;
  }
}

// The turn axis: a degree is 4.5 mm between the wheels.
TEST(AxisFilter, FollowsACoarseCounter) {
  EXPECT_LT(follow({.true_step_mm = 4.503, .told_step_mm = 4.503}).rmse_mm_s, 5.0);
}

// As much as does not fade: all of it, if that takes long enough.
TEST(AxisFilter, FindsWhatDisturbsTheMotors) {
  const double lost_mm_s = 0.08 * 100.0;  // of the second half's command of -100
  EXPECT_NEAR(follow({.told_gain = 1.0, .disturbance_lag_s = 20.0}).disturbance_mm_s, lost_mm_s,
              1.5);
  const double fading_mm_s = follow({.told_gain = 1.0}).disturbance_mm_s;
  EXPECT_GT(fading_mm_s, 0.0);
  EXPECT_LT(fading_mm_s, lost_mm_s);
}

TEST(AxisFilter, DoesWorseWithAWrongStep) {
  const double right = follow({}).rmse_mm_s;
  EXPECT_GT(follow({.told_step_mm = 1.1}).rmse_mm_s, 4.0 * right);
  EXPECT_GT(follow({.told_step_mm = 0.9}).rmse_mm_s, 4.0 * right);
}

TEST(AxisFilter, DoesWorseWithTheWrongKindOfRemainder) {
  Axis axis{1.0, Remainder::lost};
  AxisFilter carried{{}};
  AxisFilter lost{{}};
  for (int tick = 0; tick < 200; ++tick) {
    axis.tick(100.0);
    carried.predict(100.0, kResponse, {});
    lost.predict(100.0, kResponse, {});
    const int count = axis.read();
    carried.read(count, Remainder::carried);
    lost.read(count, Remainder::lost);
  }
  EXPECT_LT(std::abs(lost.speed_mm_s() - 100.0), 10.0);
  EXPECT_GT(std::abs(carried.speed_mm_s() - 100.0), 20.0) << "half a step each tick: 33 mm/s";
}

// At 15 mm/s each reading of a counter that loses the remainder is 0 whatever the robot does.
TEST(AxisFilter, LearnsNothingFromReadingsThatCouldNotBeOtherwise) {
  Axis axis{1.0, Remainder::lost};
  AxisFilter filter{{}};
  for (int tick = 0; tick < 400; ++tick) {
    axis.tick(15.0);
    filter.predict(15.0, kResponse, of_gain(0.08, 15.0));
    ASSERT_EQ(axis.read(), 0);
    filter.read(0, Remainder::lost);
  }
  EXPECT_NEAR(filter.speed_mm_s(), 15.0, 5.0);
}

TEST(AxisFilter, HoldsStillWhereNothingMoves) {
  AxisFilter filter{{}};
  for (int tick = 0; tick < 1000; ++tick) {
    filter.predict(0.0, kResponse, {});
    filter.read(0, Remainder::carried);
  }
  EXPECT_NEAR(filter.speed_mm_s(), 0.0, 1e-6);
}

// A robot that stands still is not pushed by what it was disturbed by.
TEST(AxisFilter, StopsWhereNothingDrivesTheWheels) {
  AxisFilter filter{{}};
  for (int tick = 0; tick < 200; ++tick) {
    filter.predict(200.0, kResponse, {});
    if (tick % 20 == 19) filter.read(54, Remainder::lost);  // 180 mm/s
  }
  ASSERT_LT(filter.disturbance_mm_s(), -3.0);
  for (int tick = 0; tick < 67; ++tick) {
    filter.coast(kResponse, {});
    filter.read(0, Remainder::lost);
  }
  EXPECT_NEAR(filter.speed_mm_s(), 0.0, 1.0);
  EXPECT_NEAR(filter.disturbance_mm_s(), 0.0, 1.0);
}

// What stays is the gain's to explain.
TEST(AxisFilter, LetsADisturbanceFade) {
  AxisFilter filter{{.disturbance_lag_s = 0.3}};
  for (int tick = 0; tick < 200; ++tick) {
    filter.predict(200.0, kResponse, {});
    filter.read(3 - tick % 2, Remainder::carried);  // 167 mm/s
  }
  const double before_mm_s = filter.disturbance_mm_s();
  ASSERT_LT(before_mm_s, -5.0);
  for (int tick = 0; tick < 20; ++tick) filter.predict(200.0, kResponse, {});  // 0.3 s
  EXPECT_NEAR(filter.disturbance_mm_s(), before_mm_s * std::exp(-1.0), 1e-9);
}

// The probability of each count, minus the floor that every count has.
double probability_of(AxisFilter filter, int count, Remainder remainder) {
  constexpr double kLeast = 1e-4;
  return (std::exp(filter.read(count, remainder)) - kLeast) / (1.0 - kLeast);
}

TEST(AxisFilter, GivesTheCountsProbabilitiesThatSumToOne) {
  for (const double command_mm_s : {0.0, 30.0, 200.0, -350.0}) {
    for (const int reads_before : {0, 1, 7, 60}) {
      AxisFilter filter{{}};
      Axis axis{1.0, Remainder::carried};
      for (int tick = 0; tick < reads_before; ++tick) {
        axis.tick(command_mm_s);
        filter.predict(command_mm_s, kResponse, of_gain(0.08, command_mm_s));
        filter.read(axis.read(), Remainder::carried);
      }
      filter.predict(command_mm_s, kResponse, {});
      double sum = 0.0;
      for (int count = -40; count <= 40; ++count) {
        const double probability = probability_of(filter, count, Remainder::carried);
        EXPECT_GE(probability, -1e-12);
        sum += probability;
      }
      EXPECT_NEAR(sum, 1.0, 1e-9) << command_mm_s << " mm/s after " << reads_before << " readings";
    }
  }
}

TEST(AxisFilter, DeniesNoCountAltogether) {
  AxisFilter filter{{}};
  filter.predict(0.0, kResponse, {});
  EXPECT_NEAR(filter.read(32767, Remainder::carried), std::log(1e-4), 1e-6);
}

TEST(AxisFilter, DoesNotMoveWhereAReadingWentUnseen) {
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    Axis axis{1.0, remainder};
    AxisFilter filter{{}};
    for (int tick = 1; tick <= 400; ++tick) {
      axis.tick(200.0);
      filter.predict(200.0, kResponse, {});
      if (tick % 10 != 0) continue;
      const int count = axis.read();
      if (tick % 50 == 0) {
        filter.read_unseen(remainder);
      } else {
        filter.read(count, remainder);
      }
      if (tick > 100) {
        ASSERT_NEAR(filter.speed_mm_s(), 200.0, 6.0) << tick;
      }
    }
  }
}

// A wheel that coasts against its new direction counts the wrong way: when told so, the filter
// gives the counter less weight.
TEST(AxisFilter, GivesACounterThatMayGoAstrayLessToSay) {
  const auto jolt = [](double position_sd_mm) {
    AxisFilter filter{{}};
    for (int tick = 0; tick < 100; ++tick) {
      filter.predict(200.0, kResponse, {});
      filter.read(3, Remainder::carried);
    }
    const double before_mm_s = filter.speed_mm_s();
    filter.predict(200.0, kResponse, of_position(position_sd_mm));
    filter.read(-3, Remainder::carried);
    return std::abs(filter.speed_mm_s() - before_mm_s);
  };
  EXPECT_LT(jolt(6.0), 0.25 * jolt(0.0));
}

TEST(AxisFilter, StaysFiniteWhateverIsRead) {
  std::mt19937 random{7};
  std::uniform_int_distribution<int> any{-32768, 32767};
  std::uniform_int_distribution<int> small{-1, 1};
  std::uniform_real_distribution<double> command{-500.0, 500.0};
  for (const Remainder remainder : {Remainder::carried, Remainder::lost}) {
    AxisFilter filter{{}};
    for (int tick = 0; tick < 20'000; ++tick) {
      filter.predict(command(random), kResponse, of_speed(8.0));
      if (tick % 3 == 0) continue;
      const double log_probability =
          filter.read(tick % 2 == 0 ? any(random) : small(random), remainder);
      ASSERT_TRUE(std::isfinite(filter.speed_mm_s())) << tick;
      ASSERT_TRUE(std::isfinite(log_probability)) << tick;
      ASSERT_LE(log_probability, 1e-12) << tick;
      ASSERT_GT(filter.speed_variance(), 0.0) << tick;
    }
    for (int tick = 0; tick < 200; ++tick) {
      filter.predict(200.0, kResponse, of_speed(8.0));
      filter.read(3, remainder);
    }
    EXPECT_NEAR(filter.speed_mm_s(), remainder == Remainder::carried ? 200.0 : 230.0, 35.0)
        << "and finds back";
  }
}

TEST(AxisFilter, ForgetsOnReset) {
  AxisFilter filter{{}};
  AxisFilter fresh{{}};
  for (int tick = 0; tick < 50; ++tick) {
    filter.predict(300.0, kResponse, of_speed(8.0));
    filter.read(4, Remainder::carried);
  }
  filter.reset();
  EXPECT_EQ(filter.speed_mm_s(), 0.0);
  EXPECT_EQ(filter.disturbance_mm_s(), 0.0);
  filter.predict(100.0, kResponse, of_speed(8.0));
  fresh.predict(100.0, kResponse, of_speed(8.0));
  EXPECT_EQ(filter.read(1, Remainder::carried), fresh.read(1, Remainder::carried));
  EXPECT_EQ(filter.speed_mm_s(), fresh.speed_mm_s());
}

}  // namespace
}  // namespace cargobay::rt
