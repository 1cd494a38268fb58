// A gamepad as something that drives: the left stick, while a shoulder button is held.
#pragma once

#include <cstdint>
#include <string>

struct libevdev;

namespace cargobay::gamepad {

// What its stick says now, from -1 to 1: forward, and left positive.
struct Stick {
  double forward = 0.0;
  double turn = 0.0;
};

// Follows the events of one device. The device outlives it. One thread; no I/O.
class Gamepad {
 public:
  // Whether the device is one: a stick, and shoulder buttons.
  static bool is_one(const libevdev* device);

  explicit Gamepad(const libevdev* device) : device_{device} {}

  // Whether a shoulder button is held. Without that the robot stands, wherever the stick is.
  bool is_held() const;
  // 0 within the middle tenth of the stick, which no stick leaves by itself; from there evenly to 1
  // at its end.
  Stick stick() const;
  // "drive FORWARD TURN" or "stand", as cargobay-gamepad prints it.
  std::string line() const;

 private:
  double part(unsigned axis) const;

  const libevdev* device_;
};

}  // namespace cargobay::gamepad
