// Packets 19 and 20: what the robot computes from its encoder counts. Every read takes whole
// millimetres or degrees, truncated toward zero, and clears them, whatever the read (OI p. 18, 19).
#pragma once

#include <cstdint>

#include "hal/sim/parameters.hpp"
#include "oi/units.hpp"

namespace cargobay::hal::sim {

class Odometer {
 public:
  explicit Odometer(const Parameters& parameters);

  // Takes the new resolution and wheel base, from the next tick on.
  void set(const WheelParameters& parameters);
  // Takes the counts of the encoders at a tick.
  void latch(std::int64_t left_counts, std::int64_t right_counts);

  // Distance and angle since the last read, limited to 16 bits.
  oi::Mm take_distance();
  oi::Deg take_angle();

  // The same without reading, as the Wait commands watch it (OI p. 16).
  double distance_mm() const { return distance_mm_; }
  double angle_deg() const { return angle_deg_; }
  void reset_distance() { distance_mm_ = 0.0; }
  void reset_angle() { angle_deg_ = 0.0; }

 private:
  std::int32_t take(double& sum) const;

  Remainder remainder_;
  double mm_per_count_;
  double deg_per_mm_;
  std::int64_t left_counts_ = 0;
  std::int64_t right_counts_ = 0;
  double distance_mm_ = 0.0;
  double angle_deg_ = 0.0;
};

}  // namespace cargobay::hal::sim
