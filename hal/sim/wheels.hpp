// The drive train and where it takes the robot: two wheels with lag, droop and dead band, their
// encoders, and the pose. No clock: time passes only through advance().
#pragma once

#include <cstdint>

#include "hal/sim/parameters.hpp"
#include "hal/sim/random.hpp"
#include "rt/clock.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal::sim {

// Where the robot really is, on the floor: x points ahead and y to the left of where it stood at
// the beginning, counter-clockwise positive.
struct WorldPose {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double heading_rad = 0.0;
};

using rt::WheelSpeeds;

// One wheel. Between two changes its speed is an exponential, and travel and counts follow from it
// in closed form: the way time is divided into calls of advance() does not matter.
class Wheel {
 public:
  Wheel(const WheelParameters& parameters, double droop);

  // The commanded speed. Below the dead band the wheel does not turn.
  void set_command(double command_mm_s);
  // A disturbance of the speed that it is driven at, from now on.
  void set_disturbance(double disturbance_mm_s);
  void advance(double period_s);
  // Holds the wheel (it does not turn, and counts nothing) or releases it.
  void set_blocked(bool blocked);
  // Turns it from outside while its motor does not.
  void set_turned(double turned_mm_s);

  double speed_mm_s() const { return speed_mm_s_; }
  // Held, with its motor on.
  bool stalled() const { return blocked_ && motor_on(); }
  double travel_mm() const { return travel_mm_; }
  double speed_after(double period_s) const;
  double travel_after(double period_s) const;

  // Encoder counts. The encoder has one channel and cannot see the direction: its counts take the
  // sign of the commanded one, and keep the last sign after a command of 0. Turned from outside,
  // they go up either way (OI p. 16).
  std::int64_t counts() const { return counts_; }
  // All of them, regardless of direction.
  std::int64_t edges() const { return edges_; }

 private:
  void advance_one_way(double period_s);
  bool motor_on() const;
  double driven_mm_s() const;

  double lag_s_;
  double gain_;
  double dead_band_mm_s_;
  double counts_per_mm_;
  double command_mm_s_ = 0.0;
  double disturbance_mm_s_ = 0.0;
  double turned_mm_s_ = 0.0;
  double speed_mm_s_ = 0.0;
  double travel_mm_ = 0.0;
  std::int64_t direction_ = 1;
  std::int64_t counts_ = 0;
  std::int64_t edges_ = 0;
  bool blocked_ = false;
};

class Wheels {
 public:
  explicit Wheels(const Parameters& parameters);

  void set_command(WheelSpeeds command);
  void advance(rt::Duration period);
  // Draws the disturbance for the next 15 ms: call it once a tick.
  void tick();
  void place(const WorldPose& pose) { pose_ = pose; }
  void set_blocked(bool left, bool right);
  // Turns them from outside from now on, by hand or by a push. The motors are stronger.
  void set_turned(WheelSpeeds turned);

  const WorldPose& pose() const { return pose_; }
  WheelSpeeds command() const { return command_; }
  WheelSpeeds speeds() const { return {left_.speed_mm_s(), right_.speed_mm_s()}; }
  const Wheel& left() const { return left_; }
  const Wheel& right() const { return right_; }

 private:
  void step(double period_s);

  Wheel left_;
  Wheel right_;
  WheelSpeeds command_{};
  WheelSpeeds turned_{};
  WorldPose pose_{};
  double wheel_base_mm_;
  double noise_mm_s_;
  double noise_keep_;
  double left_noise_ = 0.0;  // standard deviation 1
  double right_noise_ = 0.0;
  Random random_;
};

}  // namespace cargobay::hal::sim
