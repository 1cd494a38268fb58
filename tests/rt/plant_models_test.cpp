#include "rt/plant_models.hpp"

#include <cmath>
#include <cstddef>
#include <random>

#include <gtest/gtest.h>

#include "tests/rt/plant.hpp"

namespace cargobay::rt {
namespace {

using test::Plant;

constexpr PlantModels::Grid kSmallGrid{
    .lag_s = {0.02, 0.05, 0.08, 0.1, 0.15, 0.25, 0.4, 0.5},
    .dead_time_s = {0.0, 0.02, 0.07},
    .ramp_s2_mm = {0.0, 1.0 / 900.0, 1.0 / 500.0, 1.0 / 300.0},
};

float one_of(const PlantModels::Models& models, std::size_t drive, std::size_t lag) {
  return models[drive][lag / kLanes][lag % kLanes];
}

// Of the left wheel in a model.
float speed_in(const PlantModels& models, std::size_t drive, std::size_t lag) {
  return one_of(models.wheel(0).speed, drive, lag);
}
float way_in(const PlantModels& models, Axis axis, PlantModels::Memory memory, std::size_t drive,
             std::size_t lag) {
  const auto& wheel = models.wheel(0);
  return one_of(wheel.way, drive, lag) -
         one_of(wheel.way_at[PlantModels::at(axis, memory)], drive, lag);
}

// Every model, against a plant that is integrated by itself.
TEST(PlantModels, MoveAsThePlantsOfTheGrid) {
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    for (std::size_t lag = 0; lag < PlantModels::kLags; ++lag) {
      const double slope = kSmallGrid.ramp_s2_mm[drive % PlantModels::kRamps];
      test::PlantParameters parameters{
          .gain_left = 1.0,
          .gain_right = 1.0,
          .noise_mm_s = 0.0,
          .lag_s = kSmallGrid.lag_s[lag],
          .dead_time_s = kSmallGrid.dead_time_s[drive / PlantModels::kRamps]};
      if (slope > 0.0) parameters.ramp_mm_s2 = 1.0 / slope;
      Plant plant{parameters};
      PlantModels models{kSmallGrid};
      for (int tick = 0; tick < 300; ++tick) {
        const WheelSpeeds command = tick < 90    ? WheelSpeeds{200, 120}
                                    : tick < 160 ? WheelSpeeds{-60, 30}
                                                 : WheelSpeeds{};
        plant.tick(command);
        models.step(command);
        // What begins or ends within a tick is known by its mean of the tick.
        const double slack = 15.0 * 0.02 / kSmallGrid.lag_s[lag] +
                             (slope > 0.0 ? 0.26 * kSmallGrid.tick_s / slope : 0.0);
        ASSERT_NEAR(speed_in(models, drive, lag), plant.truth().left_mm_s, slack)
            << drive << ' ' << lag << ' ' << tick;
      }
      const double way = (plant.distance_mm() - plant.turn_rad() * 258.0 / 2.0);
      EXPECT_NEAR(way_in(models, Axis::distance, PlantModels::Memory::longer, drive, lag), way, 0.1)
          << drive << ' ' << lag;
    }
  }
}

TEST(PlantModels, RememberEachAxisForItself) {
  PlantModels models{kSmallGrid};
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) models.step({100, 100});
  };
  const auto way = [&](Axis axis, PlantModels::Memory memory) {
    return way_in(models, axis, memory, 0, 0);
  };
  using enum PlantModels::Memory;
  run(60);
  const float all = way(Axis::turn, longer);
  models.remember(Axis::distance, last_reading, 0.0F);
  models.remember(Axis::distance, longer, 0.25F);
  EXPECT_EQ(way(Axis::distance, last_reading), 0.0F);
  EXPECT_NEAR(way(Axis::distance, longer), 0.25F * all, 1e-3);
  EXPECT_EQ(way(Axis::turn, last_reading), all);
  EXPECT_EQ(way(Axis::turn, longer), all);
  run(2);
  EXPECT_NEAR(way(Axis::distance, last_reading), 3.0, 1e-3);
  EXPECT_NEAR(way(Axis::turn, longer), all + 3.0, 1e-2);
}

// What the wheels do already fades, at its true speed; what they are driven at begins from nothing.
TEST(PlantModels, BeginAgainWhereTheWheelsRoll) {
  PlantModels models{kSmallGrid};
  for (int i = 0; i < 200; ++i) models.step({150, 150});
  models.begin_again({90.0, 80.0});
  const auto& left = models.wheel(0);
  EXPECT_EQ(way_in(models, Axis::turn, PlantModels::Memory::longer, 0, 3), 0.0F);
  for (int tick = 1; tick <= 100; ++tick) {
    models.step({150, 150});
    const double time_s = tick * kSmallGrid.tick_s;
    for (std::size_t lag = 0; lag < PlantModels::kLags; ++lag) {
      const double rolls = 90.0 * std::exp(-time_s / kSmallGrid.lag_s[lag]);
      const double rolled = kSmallGrid.lag_s[lag] * (90.0 - rolls);
      EXPECT_NEAR(left.rolls[lag / kLanes][lag % kLanes], rolls, 0.06);
      EXPECT_NEAR(left.rolled[lag / kLanes][lag % kLanes], rolled, 0.05);
      const double driven = 150.0 * (1.0 - std::exp(-time_s / kSmallGrid.lag_s[lag]));
      EXPECT_NEAR(speed_in(models, 0, lag), driven, 0.05);
    }
  }
}

// After days of driving a millimetre still counts.
TEST(PlantModels, KeepTheirPrecision) {
  PlantModels models{kSmallGrid};
  for (int i = 0; i < 2'000'000; ++i) models.step({500, 500});
  models.remember(Axis::distance, PlantModels::Memory::last_reading, 0.0F);
  models.step({500, 500});
  EXPECT_NEAR(way_in(models, Axis::distance, PlantModels::Memory::last_reading, 5, 7), 7.5, 0.002);
}

}  // namespace
}  // namespace cargobay::rt
