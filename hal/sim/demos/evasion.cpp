#include <algorithm>
#include <chrono>
#include <cmath>

#include "hal/sim/demos/demo_view.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kEvadeTurnMmPerSec = 120.0;
// Fast, or a robot that comes to a cliff is over it with its caster before it stands.
constexpr double kEvadeBackMmPerSec = 400.0;
constexpr rt::Duration kBrakeTime = std::chrono::milliseconds{240};

}  // namespace

void Evasion::start(const DemoView& view, double back_mm, double turn_deg) {
  // Not beyond where it began to drive this way: nothing at its back sees a cliff.
  back_mm_ = std::min(back_mm, view.travelled_mm - turned_at_mm_);
  phase_ = back_mm_ > 0.0 ? Phase::back : Phase::brake;
  turn_deg_ = turn_deg;
  began_at_ = view.now;
  began_travelled_mm_ = view.travelled_mm;
  began_turned_deg_ = view.turned_deg;
}

bool Evasion::step(const DemoView& view, WheelSpeeds& wheels) {
  const bool backed = phase_ == Phase::back && began_travelled_mm_ - view.travelled_mm >= back_mm_;
  const bool rests = phase_ == Phase::brake && view.now - began_at_ >= kBrakeTime;
  if (backed || rests) {
    phase_ = Phase::turn;
    began_turned_deg_ = view.turned_deg;
  }
  if (phase_ == Phase::turn &&
      std::abs(view.turned_deg - began_turned_deg_) >= std::abs(turn_deg_)) {
    phase_ = Phase::over;
    turned_at_mm_ = view.travelled_mm;
  }
  switch (phase_) {
    case Phase::over: return false;
    case Phase::brake: wheels = {}; return true;
    case Phase::back: wheels = straight(-kEvadeBackMmPerSec); return true;
    case Phase::turn: wheels = turn_left(std::copysign(kEvadeTurnMmPerSec, turn_deg_)); return true;
  }
  return false;
}

}  // namespace cargobay::hal::sim
