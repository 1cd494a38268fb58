// A gamepad as something that drives: the left stick, while a shoulder button is held.
#pragma once

#include <chrono>
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

  // A gamepad whose radio link is lost tells nothing more, and neither does a stick that is held
  // against its end: after this time without any event, a held button holds no longer. The link
  // itself is given up by the kernel only after seconds, or never.
  static constexpr std::chrono::seconds kSilence{2};
  using Time = std::chrono::steady_clock::time_point;

  Gamepad(const libevdev* device, Time now) : device_{device}, heard_{now} {}

  // An event has come.
  void hear(Time now) { heard_ = now; }
  // Whether it has told nothing for so long that it may be gone.
  bool is_silent(Time now) const { return now - heard_ >= kSilence; }

  // Whether a shoulder button is held. Without that the robot stands, wherever the stick is.
  bool is_held() const;
  // 0 within the middle tenth of the stick, which no stick leaves by itself; from there evenly to 1
  // at its end.
  Stick stick() const;
  // "drive FORWARD TURN", "silent" or "stand", as cargobay-gamepad prints it.
  std::string line(Time now) const;

 private:
  double part(unsigned axis) const;

  const libevdev* device_;
  Time heard_;
};

}  // namespace cargobay::gamepad
