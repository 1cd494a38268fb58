// The drive train and where it takes the robot: two wheels, their common dead time, noise, and the
// pose. No clock: time passes only through advance().
#pragma once

#include "hal/sim/drive_train/command_delay.hpp"
#include "hal/sim/drive_train/wheel.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/pose.hpp"
#include "hal/sim/random.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class Wheels {
 public:
  explicit Wheels(const Parameters& parameters);

  // Takes the new values, and goes on from where it is.
  void set(const WheelParameters& parameters);
  // Acts after the dead time.
  void set_command(WheelSpeeds command);
  void advance(rt::Duration period);
  // Draws the disturbance for the next 15 ms: call it once a tick.
  void tick();
  void place(const WorldPose& pose) { pose_ = pose; }
  void set_blocked(bool left, bool right);
  // Turns them from outside from now on, by hand or by a push. The motors are stronger.
  void set_turned(WheelSpeeds turned);
  // What a load leaves of the speed that they are driven at: 1 without.
  void set_load(double left, double right);

  const WorldPose& pose() const { return pose_; }
  // The last, also if it has not arrived yet.
  WheelSpeeds command() const { return command_; }
  // Over the floor.
  WheelSpeeds speeds() const;
  const Wheel& left() const { return left_; }
  const Wheel& right() const { return right_; }

 private:
  void pass(rt::Duration period);
  void glide(rt::Duration period);
  void step(double period_s);
  void tell(WheelSpeeds command);
  bool rests() const { return left_.rests() && right_.rests(); }

  Wheel left_;
  Wheel right_;
  CommandDelay delay_{};
  rt::Duration dead_time_;
  rt::Duration inner_period_;  // of the controller inside the robot
  rt::Duration now_{0};
  WheelSpeeds command_{};
  WorldPose pose_{};
  double wheel_base_mm_;
  double noise_mm_s_;
  double noise_keep_;
  double left_noise_ = 0.0;  // standard deviation 1
  double right_noise_ = 0.0;
  Random random_;
};

}  // namespace cargobay::hal::sim
