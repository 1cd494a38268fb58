#include "hal/sim/drive_train/motor.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::hal::sim {

namespace {

// Below this speed a wheel whose command is 0 stops; an exponential never would.
constexpr double kStandsBelowMmPerSec = 1e-6;
// A wheel with stiction comes to rest from this speed.
constexpr double kRestsBelowMmPerSec = 1.0;
// A shorter lag bends the path more sharply than a step of 15 ms can follow.
constexpr double kShortLagS = 0.030;
constexpr double kAbout = 1.0 + 1e-9;

int sign_of(double value) { return (value > 0.0 ? 1 : 0) - (value < 0.0 ? 1 : 0); }

}  // namespace

Motor::Motor(const WheelParameters& parameters, Side side) : side_{side}, parameters_{parameters} {}

void Motor::set(const WheelParameters& parameters) {
  parameters_ = parameters;
  set_command(command_mm_s_);
}

void Motor::set_command(double command_mm_s) {
  command_mm_s_ = command_mm_s;
  goal_mm_s_ = shaped_mm_s(command_mm_s);
  if (parameters_.ramp_mm_s2 == 0.0) reference_mm_s_ = goal_mm_s_;
  rest_if_stiff();
  if (!on()) inner_.release();
}

void Motor::set_turned(double turned_mm_s) {
  turned_mm_s_ = turned_mm_s;
  rest_if_stiff();
}

void Motor::begin_counting(std::int64_t counts) { inner_.begin(speed_mm_s_, counts); }

void Motor::set_held(bool held) {
  held_ = held;
  if (held) speed_mm_s_ = 0.0;
}

void Motor::tick(std::int64_t counts) {
  if (!on()) return inner_.look(counts);
  const InnerController::Gains gains{.period_s = parameters_.inner_period_s,
                                     .proportional = parameters_.inner_p,
                                     .integral_per_s = parameters_.inner_i_per_s};
  inner_.tick(gains, parameters_.gain(side_) * reference_mm_s_, counts, parameters_.counts_per_mm);
}

bool Motor::rests() const {
  return speed_mm_s_ == 0.0 && command_mm_s_ == 0.0 && turned_mm_s_ == 0.0 && !on();
}

int Motor::way() const {
  const bool ramped = reference_mm_s_ != goal_mm_s_ && reference_mm_s_ != 0.0;
  return sign_of(ramped ? reference_mm_s_ : command_mm_s_);
}

// The lowest speed is that of the dead band, and the others are whole steps above it: 11, 40, 68,
// 97 mm/s, as an owner measured them.
double Motor::shaped_mm_s(double command_mm_s) const {
  const double size_mm_s = std::abs(command_mm_s);
  const double lowest_mm_s = parameters_.dead_band_mm_s;
  if (size_mm_s < lowest_mm_s) return 0.0;
  if (parameters_.step_mm_s == 0.0) return command_mm_s;
  const double steps = std::round((size_mm_s - lowest_mm_s) / parameters_.step_mm_s);
  return std::copysign(lowest_mm_s + steps * parameters_.step_mm_s, command_mm_s);
}

// To where the ramp leads first: from one way to the other by way of 0.
double Motor::ramp_end_from(double reference_mm_s) const {
  return reference_mm_s * goal_mm_s_ < 0.0 ? 0.0 : goal_mm_s_;
}

double Motor::slope_mm_s2() const {
  return parameters_.ramp_mm_s2 * sign_of(ramp_end_from(reference_mm_s_) - reference_mm_s_);
}

// What acts on a wheel that stands.
double Motor::effort_mm_s() const {
  return parameters_.response == Response::counting ? inner_.drive_mm_s() : reference_mm_s_;
}

bool Motor::sticks() const {
  return speed_mm_s_ == 0.0 && on() && std::abs(effort_mm_s()) < parameters_.stiction_mm_s;
}

bool Motor::stands_still() const { return held_ || sticks(); }

Motion Motor::motion() const {
  Motion motion{.speed_mm_s = speed_mm_s_, .target_mm_s = turned_mm_s_, .lag_s = parameters_.lag_s};
  if (!on()) return motion;
  if (parameters_.response == Response::counting) {
    motion.target_mm_s = load_ * inner_.drive_mm_s() + disturbance_mm_s_;
    return motion;
  }
  const double gain = parameters_.gain(side_) * load_;
  motion.target_mm_s = gain * reference_mm_s_ + disturbance_mm_s_;
  motion.slope_mm_s2 = gain * slope_mm_s2();
  return motion;
}

double Motor::speed_after(double time_s) const {
  if (stands_still() || time_s <= 0.0) return speed_mm_s_;
  return motion().speed_after(time_s);
}

double Motor::travel_after(double time_s) const {
  if (stands_still() || time_s <= 0.0) return travel_mm_;
  return motion().travel_after(travel_mm_, time_s);
}

double Motor::until_change_s(double within_s) const {
  double until_s = within_s;
  if (parameters_.lag_s < kShortLagS && !stands_still() && !motion().is_steady())
    until_s = std::min(until_s, 0.5 * parameters_.lag_s);
  if (const double slope = slope_mm_s2(); slope != 0.0) {
    until_s = std::min(until_s, (ramp_end_from(reference_mm_s_) - reference_mm_s_) / slope);
    const double short_by_mm_s = parameters_.stiction_mm_s - std::abs(reference_mm_s_);
    if (sticks() && short_by_mm_s > 0.0 && std::abs(goal_mm_s_) > std::abs(reference_mm_s_))
      until_s = std::min(until_s, short_by_mm_s / std::abs(slope));
  }
  if (parameters_.stiction_mm_s == 0.0 || stands_still()) return until_s;
  until_s = std::min(until_s, until_reversal_s(until_s));
  const double speed_mm_s = std::abs(speed_mm_s_);
  if (coasts() && speed_mm_s > kRestsBelowMmPerSec)
    until_s = std::min(until_s, parameters_.lag_s * std::log(speed_mm_s / kRestsBelowMmPerSec));
  return until_s;
}

double Motor::until_reversal_s(double within_s) const {
  return stands_still() ? Motion::kNever : motion().reversal(within_s);
}

void Motor::advance(double time_s) {
  const double former_mm_s = speed_mm_s_;
  const bool stuck = sticks();
  const double travel_mm = travel_after(time_s);
  speed_mm_s_ = speed_after(time_s);
  travel_mm_ = travel_mm;
  settle(former_mm_s);
  advance_ramp(time_s, stuck);
  rest_if_stiff();
}

void Motor::advance_ramp(double time_s, bool stuck) {
  const double slope = slope_mm_s2();
  if (slope == 0.0) return;
  const double former_mm_s = reference_mm_s_;
  // Rounding must not leave it short of where it is to arrive.
  const auto arrives_at = [=](double place_mm_s) {
    return (place_mm_s - former_mm_s) / slope <= time_s * kAbout;
  };
  const double loose_mm_s = sign_of(slope) * parameters_.stiction_mm_s;
  reference_mm_s_ += slope * time_s;
  if (stuck && former_mm_s * slope >= 0.0 && arrives_at(loose_mm_s)) reference_mm_s_ = loose_mm_s;
  if (arrives_at(ramp_end_from(former_mm_s))) reference_mm_s_ = ramp_end_from(former_mm_s);
  if (!on()) inner_.release();
}

bool Motor::coasts() const { return !on() && turned_mm_s_ == 0.0; }

// Lets a wheel stand that has as good as stopped; with stiction, also one that turns around.
void Motor::settle(double former_mm_s) {
  const double size_mm_s = std::abs(speed_mm_s_);
  const bool turns_around = parameters_.stiction_mm_s > 0.0 && std::abs(former_mm_s) > size_mm_s;
  if (size_mm_s < kStandsBelowMmPerSec && (coasts() || turns_around)) speed_mm_s_ = 0.0;
}

void Motor::rest_if_stiff() {
  const bool slow = std::abs(speed_mm_s_) <= kRestsBelowMmPerSec * kAbout;
  if (parameters_.stiction_mm_s > 0.0 && slow && coasts()) speed_mm_s_ = 0.0;
}

}  // namespace cargobay::hal::sim
