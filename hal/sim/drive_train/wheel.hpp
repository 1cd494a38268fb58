// One wheel: its motor and its encoder.
#pragma once

#include <cstdint>

#include "hal/sim/drive_train/encoder.hpp"
#include "hal/sim/drive_train/motor.hpp"
#include "hal/sim/wheel_parameters.hpp"

namespace cargobay::hal::sim {

class Wheel {
 public:
  Wheel(const WheelParameters& parameters, Side side);

  // Takes the new values, and turns and counts on from where it is.
  void set(const WheelParameters& parameters);
  // The commanded speed. Below the dead band the wheel does not turn.
  void set_command(double command_mm_s);
  // A disturbance of the speed that it is driven at, from now on.
  void set_disturbance(double disturbance_mm_s) { motor_.set_disturbance(disturbance_mm_s); }
  // What a load leaves of the speed that it is driven at.
  void set_load(double factor) { motor_.set_load(factor); }
  void advance(double period_s);
  // A tick of the controller inside the robot, if it has one.
  void tick() { motor_.tick(encoder_.counts()); }
  // Holds the wheel (it does not turn, and counts nothing) or releases it.
  void set_blocked(bool blocked) { motor_.set_held(blocked); }
  // Turns it from outside while its motor does not.
  void set_turned(double turned_mm_s);

  // How fast it turns, and how far it has turned; what the floor makes of it is slip's.
  double speed_mm_s() const { return motor_.speed_mm_s(); }
  double travel_mm() const { return motor_.travel_mm(); }
  // Up to the next change only, which is at most `within_s` away.
  double speed_after(double time_s) const { return motor_.speed_after(time_s); }
  double travel_after(double time_s) const { return motor_.travel_after(time_s); }
  double until_change_s(double within_s) const { return motor_.until_change_s(within_s); }

  // It does not turn, and will not unless something happens.
  bool rests() const { return motor_.rests(); }
  // Held, with its motor on.
  bool stalled() const { return motor_.held() && motor_.on(); }
  // The part of its turning that moves it over the floor.
  double grip() const { return grip_; }

  // Encoder counts. With one channel the encoder cannot see the direction: its counts take the sign
  // of the commanded one, and keep the last sign after a command of 0. Turned from outside, they go
  // up either way (OI p. 16).
  std::int64_t counts() const { return encoder_.counts(); }
  // As the raw counters have them, regardless of direction unless the encoder sees it.
  std::int64_t edges() const { return encoder_.edges(); }

 private:
  void roll(double period_s);
  void take_direction();

  Side side_;
  Motor motor_;
  Encoder encoder_;
  double grip_;
  double turned_mm_s_ = 0.0;
  std::int64_t direction_ = 1;
  bool counting_;
};

}  // namespace cargobay::hal::sim
