// A robot model for this folder only, independent of hal/sim: two wheels with a first-order lag and
// a droop, and the counters that a reading truncates.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "rt/axis_filter.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt::test {

struct PlantParameters {
  Remainder remainder = Remainder::carried;
  unsigned seed = 1;
  double droop_left = 0.06;
  double droop_right = 0.10;
  double noise_mm_s = 1.0;  // of a wheel's speed, each tick
  double lag_s = 0.100;
  double delay_s = 0.0025;  // from the tick until its command acts
  double wheel_base_mm = 258.0;
};

class Plant {
 public:
  static constexpr double kTick = 0.015;  // seconds

  explicit Plant(const PlantParameters& parameters)
      : parameters_{parameters}, random_{parameters.seed} {}

  // One tick; `command` is what was sent in answer to the frame before.
  void tick(const WheelSpeeds& command) {
    left_.run(former_.left_mm_s * (1.0 - parameters_.droop_left), parameters_.delay_s, parameters_);
    right_.run(former_.right_mm_s * (1.0 - parameters_.droop_right), parameters_.delay_s,
               parameters_);
    const double rest_s = kTick - parameters_.delay_s;
    left_.run(command.left_mm_s * (1.0 - parameters_.droop_left), rest_s, parameters_);
    right_.run(command.right_mm_s * (1.0 - parameters_.droop_right), rest_s, parameters_);
    if (command != WheelSpeeds{}) {
      left_.speed_mm_s += parameters_.noise_mm_s * normal_(random_);
      right_.speed_mm_s += parameters_.noise_mm_s * normal_(random_);
    }
    former_ = command;
  }

  // Reads both counters, and so clears them.
  WheelEstimator::Reading read() {
    distance_mm_ += (left_.travel_mm + right_.travel_mm) / 2.0;
    angle_deg_ +=
        (right_.travel_mm - left_.travel_mm) / parameters_.wheel_base_mm * 180.0 / std::numbers::pi;
    left_.travel_mm = right_.travel_mm = 0.0;
    return {.distance_mm = take(distance_mm_), .angle_deg = take(angle_deg_)};
  }

  WheelSpeeds truth() const { return {left_.speed_mm_s, right_.speed_mm_s}; }
  // The whole way, read or not.
  double distance_mm() const { return (left_.way_mm + right_.way_mm) / 2.0; }
  double turn_rad() const { return (right_.way_mm - left_.way_mm) / parameters_.wheel_base_mm; }

 private:
  struct Wheel {
    double speed_mm_s = 0.0;
    double travel_mm = 0.0;  // since the last read
    double way_mm = 0.0;
    void run(double driven_mm_s, double period_s, const PlantParameters& parameters) {
      const double decay = std::exp(-period_s / parameters.lag_s);
      const double moved_mm =
          driven_mm_s * period_s + (speed_mm_s - driven_mm_s) * parameters.lag_s * (1.0 - decay);
      travel_mm += moved_mm;
      way_mm += moved_mm;
      speed_mm_s = driven_mm_s + (speed_mm_s - driven_mm_s) * decay;
    }
  };

  int take(double& counter) const {
    const double whole = std::trunc(counter);
    counter = parameters_.remainder == Remainder::carried ? counter - whole : 0.0;
    return static_cast<int>(whole);
  }

  PlantParameters parameters_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Wheel left_;
  Wheel right_;
  WheelSpeeds former_{};
  double distance_mm_ = 0.0;
  double angle_deg_ = 0.0;
};

}  // namespace cargobay::rt::test
