#include "rt/plant_models.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::rt {
namespace {

constexpr double kNoLimit = 1e6;     // mm/s, to the change in a tick
constexpr float kSmallMm = 4096.0F;  // up to here a float tells half a micrometre apart
constexpr float kStandsMmS = 0.05F;

}  // namespace

PlantModels::PlantModels(const Grid& grid) : tick_s_{static_cast<float>(grid.tick_s)} {
  for (std::size_t i = 0; i < kLags; ++i) {
    const double decay = std::exp(-grid.tick_s / grid.lag_s[i]);
    decay_[i / kLanes][i % kLanes] = static_cast<float>(decay);
    way_by_speed_s_[i / kLanes][i % kLanes] = static_cast<float>(grid.lag_s[i] * (1.0 - decay));
  }
  for (std::size_t i = 0; i < kDeadTimes; ++i) {
    // A loop with a tick much shorter than a robot's has no history for that long.
    const double delay = std::min((grid.input_delay_s + grid.dead_time_s[i]) / grid.tick_s,
                                  static_cast<double>(kHistory - 2));
    whole_ticks_[i] = static_cast<std::size_t>(delay);
    part_tick_[i] = static_cast<float>(delay - std::floor(delay));
  }
  for (std::size_t i = 0; i < kRamps; ++i) {
    const double ramp = grid.ramp_s2_mm[i];
    most_mm_s_[i] = static_cast<float>(ramp > 0.0 ? grid.tick_s / ramp : kNoLimit);
    reached_[i] = ramp > 0.0 ? 0.5F : 1.0F;
  }
}

void PlantModels::reset() CARGOBAY_NONBLOCKING {
  wheels_ = {};
  commands_ = {};
  rolls_ = false;
}

void PlantModels::step(const WheelSpeeds& command) CARGOBAY_NONBLOCKING {
  now_ = (now_ + 1) % kHistory;
  commands_[now_] = {static_cast<float>(command.left_mm_s), static_cast<float>(command.right_mm_s)};
  for (std::size_t which = 0; which < wheels_.size(); ++which) {
    Wheel& wheel = wheels_[which];
    drive(wheel, which);
    follow(wheel);
    if (rolls_) roll(wheel);
    if (std::abs(wheel.way[0][0][0]) > kSmallMm) keep_small(wheel);
  }
  const auto slowest = [](const Wheel& wheel) CARGOBAY_NONBLOCKING {
    return std::abs(wheel.rolls.back()[kLanes - 1]);
  };
  if (rolls_ && slowest(wheels_[0]) + slowest(wheels_[1]) < kStandsMmS) rolls_ = false;
}

// Dead time and ramp: in the first part of the tick, the command before still acts.
void PlantModels::drive(Wheel& wheel, std::size_t which) CARGOBAY_NONBLOCKING {
  for (std::size_t group = 0; group < kDeadTimes; ++group) {
    const std::size_t newer = now_ + kHistory - whole_ticks_[group];
    const float part = part_tick_[group];
    const Lanes begin = wheel.ramped[group];
    const Lanes first = ramp(commands_[(newer - 1) % kHistory][which] - begin, part);
    const Lanes middle = begin + first;
    const Lanes rest = ramp(commands_[newer % kHistory][which] - middle, 1.0F - part);
    wheel.ramped[group] = middle + rest;
    wheel.input[group] =
        part * (begin + reached_ * first) + (1.0F - part) * (middle + reached_ * rest);
  }
}

// The change of the drive in this part of a tick.
Lanes PlantModels::ramp(const Lanes& wanted_mm_s, float part) const CARGOBAY_NONBLOCKING {
  const Lanes most = part * most_mm_s_;
  return least(greatest(wanted_mm_s, -most), most);
}

// The lag.
void PlantModels::follow(Wheel& wheel) const CARGOBAY_NONBLOCKING {
  for (std::size_t i = 0; i < kDrives; ++i) {
    const float input = wheel.input[i / kRamps][i % kRamps];
    const float driven = tick_s_ * input;
    for (std::size_t part = 0; part < kParts; ++part) {
      const Lanes excess = wheel.speed[i][part] - input;
      wheel.way[i][part] += driven + way_by_speed_s_[part] * excess;
      wheel.speed[i][part] = input + decay_[part] * excess;
    }
  }
}

void PlantModels::roll(Wheel& wheel) const CARGOBAY_NONBLOCKING {
  for (std::size_t part = 0; part < kParts; ++part) {
    wheel.rolled[part] += way_by_speed_s_[part] * wheel.rolls[part];
    wheel.rolls[part] *= decay_[part];
  }
}

// Only differences of ways count.
void PlantModels::keep_small(Wheel& wheel) CARGOBAY_NONBLOCKING {
  const float begin = wheel.way[0][0][0];
  const auto move = [begin](Models& ways) CARGOBAY_NONBLOCKING {
    for (Lags& lags : ways) {
      for (Lanes& way : lags) way -= begin;
    }
  };
  move(wheel.way);
  for (Models& ways : wheel.way_at) move(ways);
}

void PlantModels::begin_again(const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  for (std::size_t which = 0; which < wheels_.size(); ++which) {
    Wheel& wheel = wheels_[which];
    wheel.speed = {};
    wheel.rolls.fill(
        all_lanes(static_cast<float>(which == 0 ? speeds.left_mm_s : speeds.right_mm_s)));
    wheel.rolled = {};
    wheel.rolled_at = {};
    wheel.way_at.fill(wheel.way);
  }
  rolls_ = true;
}

void PlantModels::remember(Axis axis, Memory memory, float part) CARGOBAY_NONBLOCKING {
  const std::size_t which = at(axis, memory);
  const auto move = [part](Lags& at, const Lags& to) CARGOBAY_NONBLOCKING {
    for (std::size_t i = 0; i < kParts; ++i) at[i] = to[i] - part * (to[i] - at[i]);
  };
  for (Wheel& wheel : wheels_) {
    for (std::size_t i = 0; i < kDrives; ++i) move(wheel.way_at[which][i], wheel.way[i]);
    move(wheel.rolled_at[which], wheel.rolled);
  }
}

}  // namespace cargobay::rt
