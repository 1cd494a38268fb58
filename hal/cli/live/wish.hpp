// Which way a person wants the robot to go, by keys or a gamepad.
#pragma once

#include <algorithm>
#include <cmath>

#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

struct Wish {
  double forward = 0.0;  // -1 to 1
  double turn = 0.0;     // -1 to 1, left positive
  friend bool operator==(const Wish&, const Wish&) = default;
};

// A stick says where it is, not that it was moved: after a stop it counts again once it was let go.
class StickAfterStop {
 public:
  void stop() { stopped_ = true; }
  // What counts of what the stick asks for now. Call it each time.
  Wish of(const Wish& asked) {
    stopped_ = stopped_ && asked != Wish{};
    return stopped_ ? Wish{} : asked;
  }

 private:
  bool stopped_ = false;
};

// No wheel is faster than `speed_mm_s`. On the spot the robot turns at half of it: at all of it
// nobody hits an angle. In a curve the outer wheel keeps the speed.
inline rt::WheelSpeeds speeds_for(const Wish& wish, double speed_mm_s) {
  const double left = wish.forward - wish.turn / 2.0;
  const double right = wish.forward + wish.turn / 2.0;
  const double most = std::max({std::abs(left), std::abs(right), 1.0});
  return {.left_mm_s = speed_mm_s * left / most, .right_mm_s = speed_mm_s * right / most};
}

}  // namespace cargobay::cli
