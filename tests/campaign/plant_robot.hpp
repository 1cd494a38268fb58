// A robot for the campaign over plants: two wheels with dead time, steps, dead band, ramp, gain and
// lag, integrated in steps of a quarter of a millisecond; noise that wanders; counters; the pose.
// Independent of hal/sim and of the models in rt/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>

#include "rt/remainder.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::campaign {

inline constexpr double kTickS = 0.015;

struct PlantValues {
  double lag_s = 0.100;
  double dead_time_s = 0.0;  // below 0.1
  std::optional<double> ramp_mm_s2{};
  double gain_left = 0.94;
  double gain_right = 0.90;
  double dead_band_mm_s = 10.0;
  double step_mm_s = 0.0;  // 0: none
  double noise_mm_s = 1.0;
  double wheel_base_mm = 258.0;
  rt::Remainder remainder = rt::Remainder::carried;
  bool counts_by_command = false;  // with the sign of the command, whichever way the wheel rolls
  // Part of what is counted that is not gone; negative where counts are missed.
  double slip_left = 0.0;
  double slip_right = 0.0;
  double base_error = 0.0;  // by which the true wheel base is larger than the robot reckons with
};

// One of the family; the same for the same seed.
inline PlantValues any_plant(std::uint64_t seed, rt::Remainder remainder) {
  std::mt19937_64 random{seed};
  const auto draw = [&random](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  PlantValues plant{.remainder = remainder};
  plant.lag_s = std::exp(draw(std::log(0.020), std::log(0.500)));
  if (draw(0.0, 1.0) > 0.3) plant.dead_time_s = draw(0.0, 0.075);
  if (draw(0.0, 1.0) > 0.5) plant.ramp_mm_s2 = std::exp(draw(std::log(250.0), std::log(2000.0)));
  const double gain = draw(0.60, 1.15);
  plant.gain_left = std::clamp(gain * draw(0.9, 1.1), 0.60, 1.15);
  plant.gain_right = std::clamp(gain * draw(0.9, 1.1), 0.60, 1.15);
  plant.dead_band_mm_s = draw(0.0, 12.0);
  const double coarse = draw(0.0, 1.0);
  if (coarse > 0.6) plant.step_mm_s = coarse > 0.8 ? 28.5 : 8.5;
  return plant;
}

// What goes wrong with a wheel.
struct WheelFault {
  double counts = 1.0;  // of its counts that are seen; below 0: with the other sign
  bool stuck = false;   // it does not turn
};

class PlantWheel {
 public:
  // The command is here now, and acts a dead time later.
  void command(double now_s, double command_mm_s) {
    waiting_[last_++ % kWaiting] = {now_s, command_mm_s};
    if (command_mm_s != 0.0) sign_ = command_mm_s > 0.0 ? 1.0 : -1.0;
  }
  void advance(double now_s, double period_s, double gain, const PlantValues& plant) {
    while (first_ < last_ &&
           waiting_[first_ % kWaiting].since_s + plant.dead_time_s <= now_s + 1e-9) {
      acting_mm_s_ = waiting_[first_++ % kWaiting].command_mm_s;
    }
    const double aim = driven_at(plant);
    const double most = plant.ramp_mm_s2 ? *plant.ramp_mm_s2 * period_s : std::abs(aim - driven_);
    driven_ += std::clamp(aim - driven_, -most, most);
    const double wanted = gain * driven_ + (driven_ != 0.0 ? noise_mm_s : 0.0);
    const double former = speed_mm_s;
    speed_mm_s = wanted + (speed_mm_s - wanted) * std::exp(-period_s / plant.lag_s);
    if (fault.stuck) speed_mm_s = 0.0;
    const double way = fault.stuck ? 0.0 : 0.5 * (former + speed_mm_s) * period_s;
    way_mm += way;
    counted_mm += fault.counts * (plant.counts_by_command ? sign_ * std::abs(way) : way);
  }

  double speed_mm_s = 0.0;
  double way_mm = 0.0;
  double counted_mm = 0.0;
  double noise_mm_s = 0.0;
  WheelFault fault{};

 private:
  struct Waiting {
    double since_s = 0.0;
    double command_mm_s = 0.0;
  };
  static constexpr std::size_t kWaiting = 16;  // ticks: longer than any dead time

  double driven_at(const PlantValues& plant) const {
    if (std::abs(acting_mm_s_) < plant.dead_band_mm_s) return 0.0;
    if (plant.step_mm_s <= 0.0) return acting_mm_s_;
    return plant.step_mm_s * std::round(acting_mm_s_ / plant.step_mm_s);
  }

  std::array<Waiting, kWaiting> waiting_{};
  std::size_t first_ = 0;
  std::size_t last_ = 0;
  double acting_mm_s_ = 0.0;
  double driven_ = 0.0;
  double sign_ = 1.0;
};

struct TruePose {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double heading_rad = 0.0;
};

class PlantRobot {
 public:
  PlantRobot(const PlantValues& plant, std::uint64_t seed) : plant_{plant}, random_{seed} {}

  // One tick; the command that answers the frame at its begin arrives 2.5 ms later.
  void tick(const rt::WheelSpeeds& command) {
    constexpr int kSteps = 60;
    constexpr int kArrives = 10;
    constexpr double kStepS = kTickS / kSteps;
    wander();
    for (int i = 0; i < kSteps; ++i) {
      const double now_s = time_s_ + i * kStepS;
      if (i == kArrives) {
        left_.command(now_s, command.left_mm_s);
        right_.command(now_s, command.right_mm_s);
      }
      const double left_mm = left_.way_mm;
      const double right_mm = right_.way_mm;
      left_.advance(now_s, kStepS, load_ * plant_.gain_left, plant_);
      right_.advance(now_s, kStepS, load_ * plant_.gain_right, plant_);
      move((1.0 - plant_.slip_left) * (left_.way_mm - left_mm),
           (1.0 - plant_.slip_right) * (right_.way_mm - right_mm));
    }
    time_s_ += kTickS;
  }

  rt::WheelEstimator::Reading read(const rt::Axes& axes) {
    const double left_mm = left_.counted_mm - read_left_mm_;
    const double right_mm = right_.counted_mm - read_right_mm_;
    read_left_mm_ = left_.counted_mm;
    read_right_mm_ = right_.counted_mm;
    distance_mm_ += 0.5 * (left_mm + right_mm);
    angle_deg_ += (right_mm - left_mm) / plant_.wheel_base_mm * 180.0 / std::numbers::pi;
    rt::WheelEstimator::Reading reading;
    if (axes.distance) reading.distance_mm = take(distance_mm_);
    if (axes.turn) reading.angle_deg = take(angle_deg_);
    return reading;
  }

  // A factor on both gains from now on.
  void load(double factor) { load_ = factor; }
  // From now on.
  void fail(const WheelFault& left, const WheelFault& right) {
    left_.fault = left;
    right_.fault = right;
  }
  rt::WheelSpeeds speeds() const { return {left_.speed_mm_s, right_.speed_mm_s}; }
  const TruePose& pose() const { return pose_; }

 private:
  static constexpr double kNoiseLagS = 0.150;

  void wander() {
    const double keep = std::exp(-kTickS / kNoiseLagS);
    for (PlantWheel* wheel : {&left_, &right_}) {
      wheel->noise_mm_s = keep * wheel->noise_mm_s +
                          std::sqrt(1.0 - keep * keep) * plant_.noise_mm_s * normal_(random_);
    }
  }
  void move(double left_mm, double right_mm) {
    const double turn_rad =
        (right_mm - left_mm) / (plant_.wheel_base_mm * (1.0 + plant_.base_error));
    const double middle_rad = pose_.heading_rad + 0.5 * turn_rad;
    pose_.x_mm += 0.5 * (left_mm + right_mm) * std::cos(middle_rad);
    pose_.y_mm += 0.5 * (left_mm + right_mm) * std::sin(middle_rad);
    pose_.heading_rad += turn_rad;
  }
  int take(double& sum) const {
    const double whole = std::trunc(sum);
    sum = plant_.remainder == rt::Remainder::carried ? sum - whole : 0.0;
    return static_cast<int>(whole);
  }

  PlantValues plant_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{};
  PlantWheel left_{};
  PlantWheel right_{};
  TruePose pose_{};
  double time_s_ = 0.0;
  double load_ = 1.0;
  double read_left_mm_ = 0.0;
  double read_right_mm_ = 0.0;
  double distance_mm_ = 0.0;
  double angle_deg_ = 0.0;
};

}  // namespace cargobay::campaign
