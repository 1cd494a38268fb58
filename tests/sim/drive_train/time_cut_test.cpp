// However time is divided into calls of advance(), the same wheels do the same.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/drive_train/wheels.hpp"
#include "hal/sim/random.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Told {
  rt::Duration after{0};
  WheelSpeeds command{};
};

std::vector<Told> drive(std::uint64_t seed) {
  Random random{seed};
  std::vector<Told> told;
  for (int i = 0; i < 25; ++i) {
    const auto speed = [&random] { return static_cast<double>(random.below(601)) - 300.0; };
    const bool stop = random.below(4) == 0;
    const rt::Duration after = std::chrono::milliseconds{10 + random.below(900)};
    told.push_back({after, stop ? WheelSpeeds{} : WheelSpeeds{speed(), 0.3 * speed()}});
  }
  return told;
}

// Cut into pieces of at most `most`.
Wheels driven(const WheelParameters& wheel_parameters, const std::vector<Told>& told,
              std::uint32_t most_us, std::uint64_t seed) {
  Random random{seed};
  Parameters parameters;
  parameters.wheels = wheel_parameters;
  parameters.wheels.noise_mm_s = 0.0;
  Wheels wheels{parameters};
  for (const Told& next : told) {
    wheels.set_command(next.command);
    for (rt::Duration left = next.after; left > 0s;) {
      const rt::Duration cut = std::chrono::microseconds{1 + random.below(most_us)};
      wheels.advance(std::min(left, cut));
      left -= std::min(left, cut);
    }
  }
  return wheels;
}

void expect_same(const std::string& plant) {
  WheelParameters parameters;
  ASSERT_EQ(set_plant(plant, parameters), "") << plant;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Told> told = drive(seed);
    const Wheels whole = driven(parameters, told, 2'000'000'000, seed);
    const Wheels cut = driven(parameters, told, 9'000, seed + 100);
    EXPECT_NEAR(whole.pose().x_mm, cut.pose().x_mm, 1e-5) << plant << " " << seed;
    EXPECT_NEAR(whole.pose().y_mm, cut.pose().y_mm, 1e-5) << plant << " " << seed;
    EXPECT_NEAR(whole.pose().heading_rad, cut.pose().heading_rad, 1e-8) << plant << " " << seed;
    EXPECT_NEAR(whole.speeds().left_mm_s, cut.speeds().left_mm_s, 1e-5) << plant << " " << seed;
    EXPECT_EQ(whole.left().counts(), cut.left().counts()) << plant << " " << seed;
    EXPECT_EQ(whole.right().counts(), cut.right().counts()) << plant << " " << seed;
    EXPECT_EQ(whole.left().edges(), cut.left().edges()) << plant << " " << seed;
  }
}

TEST(CutTime, ChangesNothingOnAnyPlant) {
  for (const Plant& plant : plants()) expect_same(std::string{plant.name});
}

TEST(CutTime, ChangesNothingWhereEverythingComesTogether) {
  expect_same("carpet dead-time 0.043 step 8.5 dead-band 7 missed-left 0.3 slip-right 0.1");
  expect_same("ramp stiction 60 lag 0.4 sign true");
  expect_same("counting ramp 250 stiction 30 dead-time 0.0225 inner-period 0.011 missed-right 0.1");
}

}  // namespace
}  // namespace cargobay::hal::sim
