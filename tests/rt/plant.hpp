// A robot model for this folder only, independent of hal/sim: two wheels with dead time, steps and
// a dead band of the command, a ramp, a gain and a first-order lag, all in closed form; and the
// counters that a reading truncates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>

#include "rt/axis_filter.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt::test {

struct PlantParameters {
  Remainder remainder = Remainder::carried;
  unsigned seed = 1;
  double gain_left = 0.94;
  double gain_right = 0.90;
  double noise_mm_s = 1.0;  // of a wheel's speed, each tick
  double lag_s = 0.100;
  double delay_s = 0.0025;   // from the tick until its command is there ...
  double dead_time_s = 0.0;  // ... and from then until it acts, up to 0.2 s
  double ramp_mm_s2 = std::numeric_limits<double>::infinity();  // of what the motors are driven at
  double step_mm_s = 0.0;       // commands act in multiples of this; 0: as they are
  double dead_band_mm_s = 0.0;  // smaller commands do not act
  double wheel_base_mm = 258.0;
  bool counts = true;  // otherwise both counters stay 0
};

class Plant {
 public:
  static constexpr double kTick = 0.015;  // seconds

  explicit Plant(const PlantParameters& parameters)
      : parameters_{parameters}, random_{parameters.seed} {}

  // One tick; `command` is what was sent in answer to the frame before.
  void tick(const WheelSpeeds& command) {
    newest_ = (newest_ + 1) % kCommands;
    commands_[newest_] = command;
    const double delay_s = parameters_.delay_s + parameters_.dead_time_s;
    const auto whole = static_cast<std::size_t>(delay_s / kTick);
    const double changes_at_s = delay_s - static_cast<double>(whole) * kTick;
    drive(commands_[(newest_ + kCommands - whole - 1) % kCommands], changes_at_s);
    drive(commands_[(newest_ + kCommands - whole) % kCommands], kTick - changes_at_s);
    if (command != WheelSpeeds{}) {
      left_.speed_mm_s += parameters_.noise_mm_s * normal_(random_);
      right_.speed_mm_s += parameters_.noise_mm_s * normal_(random_);
    }
  }

  // Reads these counters, and so clears them.
  WheelEstimator::Reading read(const Axes& axes = kBothAxes) {
    distance_mm_ += (left_.travel_mm + right_.travel_mm) / 2.0;
    angle_deg_ +=
        (right_.travel_mm - left_.travel_mm) / parameters_.wheel_base_mm * 180.0 / std::numbers::pi;
    left_.travel_mm = right_.travel_mm = 0.0;
    WheelEstimator::Reading reading;
    if (axes.distance) reading.distance_mm = parameters_.counts ? take(distance_mm_) : 0;
    if (axes.turn) reading.angle_deg = parameters_.counts ? take(angle_deg_) : 0;
    return reading;
  }

  // Changes while it drives: load, floor, another robot.
  PlantParameters& parameters() { return parameters_; }
  const PlantParameters& parameters() const { return parameters_; }

  WheelSpeeds truth() const { return {left_.speed_mm_s, right_.speed_mm_s}; }
  // The whole way, read or not.
  double distance_mm() const { return (left_.way_mm + right_.way_mm) / 2.0; }
  double turn_rad() const { return (right_.way_mm - left_.way_mm) / parameters_.wheel_base_mm; }

 private:
  static constexpr std::size_t kCommands = 16;

  struct Wheel {
    double driven_mm_s = 0.0;  // before the gain
    double speed_mm_s = 0.0;
    double travel_mm = 0.0;  // since the last read
    double way_mm = 0.0;

    void run(double aim_mm_s, double gain, double period_s, const PlantParameters& parameters) {
      if (period_s <= 0.0) return;
      const double change_mm_s = aim_mm_s - driven_mm_s;
      const double ramp_s = std::min(std::abs(change_mm_s) / parameters.ramp_mm_s2, period_s);
      const double rate_mm_s2 = std::copysign(parameters.ramp_mm_s2, change_mm_s);
      if (ramp_s > 0.0) follow(rate_mm_s2, gain, ramp_s, parameters.lag_s);
      driven_mm_s = ramp_s < period_s ? aim_mm_s : driven_mm_s + rate_mm_s2 * ramp_s;
      follow(0.0, gain, period_s - ramp_s, parameters.lag_s);
    }
    // The lag's answer to a drive that starts from driven_mm_s and changes evenly.
    void follow(double rate_mm_s2, double gain, double period_s, double lag_s) {
      const double rate = gain * rate_mm_s2;
      const double from = gain * driven_mm_s - rate * lag_s;  // where a very old ramp would be
      const double decay = std::exp(-period_s / lag_s);
      const double moved_mm = from * period_s + rate * period_s * period_s / 2.0 +
                              (speed_mm_s - from) * lag_s * (1.0 - decay);
      travel_mm += moved_mm;
      way_mm += moved_mm;
      speed_mm_s = from + rate * period_s + (speed_mm_s - from) * decay;
    }
  };

  void drive(const WheelSpeeds& command, double period_s) {
    left_.run(acting(command.left_mm_s), parameters_.gain_left, period_s, parameters_);
    right_.run(acting(command.right_mm_s), parameters_.gain_right, period_s, parameters_);
  }
  double acting(double command_mm_s) const {
    const double step = parameters_.step_mm_s;
    const double acts = step > 0.0 ? step * std::round(command_mm_s / step) : command_mm_s;
    return std::abs(acts) < parameters_.dead_band_mm_s ? 0.0 : acts;
  }

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
  std::array<WheelSpeeds, kCommands> commands_{};
  std::size_t newest_ = 0;
  double distance_mm_ = 0.0;
  double angle_deg_ = 0.0;
};

// A plant that nobody tuned anything for: any of the family that robots may come from.
inline PlantParameters any_plant(unsigned seed, Remainder remainder) {
  std::mt19937 random{seed};
  const auto draw = [&random](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  PlantParameters plant{.remainder = remainder, .seed = seed, .noise_mm_s = 0.5};
  plant.lag_s = std::exp(draw(std::log(0.020), std::log(0.500)));
  plant.dead_time_s = draw(0.0, 1.0) < 0.3 ? 0.0 : draw(0.0, 0.075);
  if (draw(0.0, 1.0) < 0.5) plant.ramp_mm_s2 = draw(250.0, 1000.0);
  plant.gain_left = draw(0.60, 1.15);
  plant.gain_right = draw(0.60, 1.15);
  if (draw(0.0, 1.0) < 0.5) plant.dead_band_mm_s = draw(0.0, 12.0);
  plant.step_mm_s = std::array{0.0, 0.0, 8.5, 28.5}[random() % 4];
  return plant;
}

}  // namespace cargobay::rt::test
