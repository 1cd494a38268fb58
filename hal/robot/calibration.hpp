// What kind of robot this is, measured by driving a known pattern in open loop: wheel base, lag and
// gain of the wheels, and what becomes of the remainder of distance and angle.
//
// Ahead and back for lag and gain; then turns about each wheel for the wheel base: with one wheel
// still, the other travels twice the distance that the robot reports, and this travel divided by
// the wheel base is the angle. No ruler is needed, and no estimate of anything else. At the end the
// robot is about where it began.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/result.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

struct CalibrationResult {
  double wheel_base_mm = 0.0;
  double wheel_base_spread_mm = 0.0;  // between the turns: greatest less least
  double lag_s = 0.0;
  double gain_left = 0.0;  // part of its command that the wheel reaches
  double gain_right = 0.0;
  rt::RemainderBelief remainder = rt::RemainderBelief::unknown;
};

class Calibration {
 public:
  // `speed_mm_s`, 100 to 400, of the wheels; the robot goes ahead about twice as many mm.
  explicit Calibration(double speed_mm_s) : speed_mm_s_{speed_mm_s} {}

  // How to set up the cycle for it: open loop, steps of the command.
  static void prepare(CycleParameters& parameters);
  static double duration_s() CARGOBAY_NONBLOCKING;

  // What the wheels should do; from the control thread.
  rt::WheelSpeeds at(double seconds) const CARGOBAY_NONBLOCKING;

  // Call with each state of the drive, in order; from one thread.
  void see(const CycleState& state);
  // Fails if the robot did not do what it was told, saying what to look at. `delay_s` is that of
  // the parameters' estimator. Takes some tenths of a second: finds the kind of remainder that
  // makes the robot's readings most likely (rt/wheel_estimator.hpp), learns the plant, and then
  // the lag more exactly.
  // `prior` is what the drive began from, if it did.
  Result<CalibrationResult> result(double delay_s,
                                   const std::optional<rt::LearntPlant>& prior = {}) const;

 private:
  struct Leg {
    double left = 0.0;  // fractions of the speed
    double right = 0.0;
    double drive_s = 0.0;
  };
  // Seconds, from the first frame on, and after each leg: until the slowest robot stands, for what
  // rolls on would count for the next leg.
  static constexpr double kSettle = 2.5;
  static constexpr double kTurn = 6.0;  // seconds
  static constexpr std::array<Leg, 6> kLegs{
      {{1, 1, 2}, {-1, -1, 2}, {0, 1, kTurn}, {0, -1, kTurn}, {1, 0, kTurn}, {-1, 0, kTurn}}};
  struct Tick {
    std::int64_t number = 0;
    rt::WheelSpeeds command{};  // that answered it
    rt::WheelEstimator::Reading reading{};
  };
  // Travel up to each tick.
  struct Way {
    double distance_mm = 0.0;
    double turn_rad = 0.0;
  };
  using Ways = std::vector<Way>;

  struct Estimate {
    double log_likelihood = 0.0;  // of the readings
    rt::PlantEstimate plant{};
  };

  // Estimates the drive with these parameters; stores the travel in `ways` unless null.
  Estimate estimate(const rt::WheelEstimator::Parameters& parameters, Ways* ways) const;
  // The lag, from kLeastLag to kMostLag, with which they are most likely if all else is as `told`.
  double likeliest_lag(rt::WheelEstimator::Parameters parameters) const;
  double lag_of(rt::WheelEstimator::Parameters parameters, const rt::PlantEstimate& plant) const;
  // Travel between two instants of the pattern.
  Way between(const Ways& ways, double from_s, double to_s) const;
  static double begin_of(std::size_t leg) CARGOBAY_NONBLOCKING;
  Result<void> measure_wheel_base(const Ways& ways, CalibrationResult& result) const;
  Result<void> measure_gain(const Ways& ways, CalibrationResult& result) const;

  double speed_mm_s_;
  std::vector<Tick> ticks_{};
};

}  // namespace cargobay::hal
