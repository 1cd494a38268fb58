// How the wheels of a virtual Create answer. hal/sim/drive_train/plants.hpp has names and ranges.
#pragma once

#include <cstdint>

#include "oi/dialect.hpp"

namespace cargobay::hal::sim {

enum class Response : std::uint8_t {
  first_order,  // a lag
  counting,     // a motor with that lag, and a controller inside the robot that counts its encoder
};

// What sign the counts of the encoders take.
enum class CounterSign : std::uint8_t {
  commanded,  // encoders with one channel cannot see the direction
  true_one,   // quadrature
};

enum class Side : std::uint8_t { left, right };

struct WheelParameters {
  Response response = Response::first_order;
  double lag_s = 0.100;      // from commanded to true speed, or of the motor; above 0
  double dead_time_s = 0.0;  // of commands
  double ramp_mm_s2 = 0.0;   // by which the command is approached; 0: at once
  double gain_left = 0.94;   // part of its command that the wheel reaches
  double gain_right = 0.90;
  double dead_band_mm_s = 10.0;  // commands below this do not turn the wheel
  double step_mm_s = 0.0;        // commands act in steps from the dead band on; 0: in none
  double stiction_mm_s = 0.0;    // commands below this do not turn a wheel that stands
  double slip_left = 0.0;  // part of its turning by which the wheel does not move on the floor
  double slip_right = 0.0;
  double missed_left = 0.0;  // part of its edges that the encoder does not see; 1: it is dead
  double missed_right = 0.0;
  CounterSign sign = CounterSign::commanded;
  double counts_per_mm = 7.8324;  // of the encoders
  double wheel_base_mm = oi::kCreate.wheel_base_mm;
  // The speed that a turning wheel is driven at wanders: standard deviation and correlation time.
  // If it is 0 mm/s the speed does not wander, and the seed does not matter.
  double noise_mm_s = 1.0;
  double noise_lag_s = 0.150;
  // Of the controller that counts.
  double inner_period_s = 0.015;
  double inner_p = 0.8;  // of 1 mm/s to 1 mm/s
  double inner_i_per_s = 10.0;

  double gain(Side side) const { return side == Side::left ? gain_left : gain_right; }
  double slip(Side side) const { return side == Side::left ? slip_left : slip_right; }
  double missed(Side side) const { return side == Side::left ? missed_left : missed_right; }
  friend bool operator==(const WheelParameters&, const WheelParameters&) = default;
};

}  // namespace cargobay::hal::sim
