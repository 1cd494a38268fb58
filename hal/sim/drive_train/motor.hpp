// The motor of a wheel and what lies between it and a command: dead band, steps, ramp, stiction,
// and a lag or a controller that counts. Between two changes its speed and its travel are known in
// closed form, so that the way time is cut does not matter.
#pragma once

#include <cstdint>

#include "hal/sim/drive_train/inner_controller.hpp"
#include "hal/sim/drive_train/motion.hpp"
#include "hal/sim/wheel_parameters.hpp"

namespace cargobay::hal::sim {

class Motor {
 public:
  Motor(const WheelParameters& parameters, Side side);

  // Takes the new values; it keeps turning as it does.
  void set(const WheelParameters& parameters);
  void set_command(double command_mm_s);
  // A disturbance of the speed that it is driven at, from now on.
  void set_disturbance(double disturbance_mm_s) { disturbance_mm_s_ = disturbance_mm_s; }
  // What is left of its gain under a load: 1 without.
  void set_load(double factor) { load_ = factor; }
  // Turns it from outside while it is off.
  void set_turned(double turned_mm_s);
  // Holds it, or lets go.
  void set_held(bool held);
  // The controller that counts takes over, without a jerk; and each of its ticks.
  void begin_counting(std::int64_t counts);
  void tick(std::int64_t counts);

  // Told to turn, or not done with turning down.
  bool on() const { return reference_mm_s_ != 0.0 || goal_mm_s_ != 0.0; }
  bool held() const { return held_; }
  // Nothing moves, and nothing will.
  bool rests() const;
  // Whether the last command was 1 or -1 way; while it is ramped, which way it is driven. 0: none.
  int way() const;

  double speed_mm_s() const { return speed_mm_s_; }
  double travel_mm() const { return travel_mm_; }
  // Before the next change only.
  double speed_after(double time_s) const;
  double travel_after(double time_s) const;
  // How much time may pass before its answer changes its form, or bends more than quadrature can
  // follow in a step; at most `within_s`.
  double until_change_s(double within_s) const;
  // When it turns around, if within that time; infinite otherwise.
  double until_reversal_s(double within_s) const;
  // To the next change or the reversal, and no further.
  void advance(double time_s);
  void turn_around() { speed_mm_s_ = 0.0; }

 private:
  double shaped_mm_s(double command_mm_s) const;
  double ramp_end_from(double reference_mm_s) const;
  double slope_mm_s2() const;
  double effort_mm_s() const;
  bool sticks() const;
  bool stands_still() const;
  bool coasts() const;
  Motion motion() const;
  void advance_ramp(double time_s, bool stuck);
  void settle(double former_mm_s);
  void rest_if_stiff();

  Side side_;
  WheelParameters parameters_;
  InnerController inner_{};
  double load_ = 1.0;
  double command_mm_s_ = 0.0;
  double goal_mm_s_ = 0.0;       // of the ramp: what dead band and steps make of the command
  double reference_mm_s_ = 0.0;  // on the ramp
  double disturbance_mm_s_ = 0.0;
  double turned_mm_s_ = 0.0;
  double speed_mm_s_ = 0.0;
  double travel_mm_ = 0.0;
  bool held_ = false;
};

}  // namespace cargobay::hal::sim
