#include "hal/sim/drive_train/wheel.hpp"

#include <algorithm>
#include <utility>

namespace cargobay::hal::sim {

Wheel::Wheel(const WheelParameters& parameters, Side side)
    : side_{side},
      motor_{parameters, side},
      encoder_{parameters.counts_per_mm, parameters.sign, parameters.missed(side)},
      grip_{1.0 - parameters.slip(side)},
      counting_{parameters.response == Response::counting} {}

void Wheel::set(const WheelParameters& parameters) {
  const bool counted = std::exchange(counting_, parameters.response == Response::counting);
  if (counting_ && !counted) motor_.begin_counting(encoder_.counts());
  motor_.set(parameters);
  encoder_.set(parameters.counts_per_mm, parameters.sign, parameters.missed(side_));
  grip_ = 1.0 - parameters.slip(side_);
}

void Wheel::set_command(double command_mm_s) {
  motor_.set_command(command_mm_s);
  take_direction();
}

void Wheel::set_turned(double turned_mm_s) {
  turned_mm_s_ = turned_mm_s;
  motor_.set_turned(turned_mm_s);
  take_direction();
}

void Wheel::take_direction() {
  const int way = motor_.way();
  if (way != 0) direction_ = way;
  if (way == 0 && turned_mm_s_ != 0.0) direction_ = 1;
}

// Forward and back over the same edge are two counts, so a change of direction ends a piece.
void Wheel::advance(double period_s) {
  while (period_s > 0.0) {
    const double smooth_s = motor_.until_change_s(period_s);
    const double reversal_s = motor_.until_reversal_s(smooth_s);
    const double piece_s = std::min(smooth_s, reversal_s);
    roll(piece_s);
    if (reversal_s <= smooth_s) motor_.turn_around();
    period_s -= piece_s;
  }
}

void Wheel::roll(double period_s) {
  const double from_mm = motor_.travel_mm();
  motor_.advance(period_s);
  encoder_.roll(from_mm, motor_.travel_mm(), direction_);
  take_direction();
}

}  // namespace cargobay::hal::sim
