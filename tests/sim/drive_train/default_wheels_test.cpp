// Recordings and other tests compare what the default wheels do bit for bit. Their formulas are
// written down here once more, as they were before the wheels knew anything but lag, gain and dead
// band, and must not differ in any bit.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "hal/sim/drive_train/wheels.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {
namespace {

// A processor that multiplies and adds in one step may round the two texts differently.
#if defined(__x86_64__) && !defined(__FMA__)
constexpr double kApart = 0.0;
#else
constexpr double kApart = 1e-9;
#endif

struct FormerWheel {
  double gain = 1.0;
  double lag_s = 0.100;
  double command_mm_s = 0.0;
  double disturbance_mm_s = 0.0;
  double speed_mm_s = 0.0;
  double travel_mm = 0.0;
  std::int64_t direction = 1;
  std::int64_t counts = 0;

  double driven() const {
    const bool on = std::abs(command_mm_s) >= 10.0 && command_mm_s != 0.0;
    return on ? gain * command_mm_s + disturbance_mm_s : 0.0;
  }
  void set_command(double to_mm_s) {
    command_mm_s = to_mm_s;
    if (to_mm_s > 0.0) direction = 1;
    if (to_mm_s < 0.0) direction = -1;
  }
  void one_way(double period_s) {
    const double to = driven();
    const double travel =
        travel_mm + to * period_s - (speed_mm_s - to) * lag_s * std::expm1(-period_s / lag_s);
    const auto passed =
        static_cast<std::int64_t>(std::floor(travel * 7.8324) - std::floor(travel_mm * 7.8324));
    counts += direction * std::abs(passed);
    speed_mm_s = to + (speed_mm_s - to) * std::exp(-period_s / lag_s);
    travel_mm = travel;
    if (std::abs(speed_mm_s) < 1e-6 && to == 0.0) speed_mm_s = 0.0;
  }
  void advance(double period_s) {
    const double to = driven();
    if (speed_mm_s * to < 0.0) {
      const double until_s = lag_s * std::log1p(-speed_mm_s / to);
      if (until_s < period_s) {
        one_way(until_s);
        speed_mm_s = 0.0;
        period_s -= until_s;
      }
    }
    one_way(period_s);
  }
};

struct FormerWheels {
  FormerWheel left{.gain = 1.0 - 0.06};
  FormerWheel right{.gain = 1.0 - 0.10};
  Random random{5};
  double left_noise = 0.0;
  double right_noise = 0.0;

  void tick() {
    // Not a constant to the compiler, whose exp() may round otherwise than the library's.
    const volatile double noise_lag_s = 0.150;
    const double keep = std::exp(-rt::seconds(oi::kTick) / noise_lag_s);
    const double fresh = std::sqrt(1.0 - keep * keep);
    left_noise = keep * left_noise + fresh * random.normal();
    right_noise = keep * right_noise + fresh * random.normal();
    left.disturbance_mm_s = 1.0 * left_noise;
    right.disturbance_mm_s = 1.0 * right_noise;
  }
  void advance(rt::Duration period) {
    if (left.speed_mm_s == 0.0 && right.speed_mm_s == 0.0 && left.command_mm_s == 0.0 &&
        right.command_mm_s == 0.0)
      return;
    double left_over_s = rt::seconds(period);
    while (left_over_s > 0.0) {
      const double period_s = std::min(left_over_s, 0.015);
      left.advance(period_s);
      right.advance(period_s);
      left_over_s -= period_s;
    }
  }
};

TEST(DefaultWheels, AreWhatTheyWereToTheLastBit) {
  FormerWheels former;
  Wheels wheels{Parameters{.seed = 5}};
  Random random{3};
  for (int i = 0; i < 20'000; ++i) {
    if (random.below(10) == 0) {
      const auto speed = [&random] { return static_cast<double>(random.below(1001)) - 500.0; };
      const bool stop = random.below(4) == 0;
      const WheelSpeeds command = stop ? WheelSpeeds{} : WheelSpeeds{speed(), speed() / 40.0};
      former.left.set_command(command.left_mm_s);
      former.right.set_command(command.right_mm_s);
      wheels.set_command(command);
    }
    const rt::Duration period = std::chrono::microseconds{random.below(20'000)};
    former.advance(period);
    wheels.advance(period);
    if (random.below(2) == 0) {
      former.tick();
      wheels.tick();
    }
    ASSERT_NEAR(wheels.speeds().left_mm_s, former.left.speed_mm_s, kApart) << i;
    ASSERT_NEAR(wheels.speeds().right_mm_s, former.right.speed_mm_s, kApart) << i;
    ASSERT_NEAR(wheels.left().travel_mm(), former.left.travel_mm, kApart) << i;
    ASSERT_NEAR(wheels.right().travel_mm(), former.right.travel_mm, kApart) << i;
    ASSERT_EQ(wheels.left().counts(), former.left.counts) << i;
    ASSERT_EQ(wheels.right().counts(), former.right.counts) << i;
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
