#include "hal/gamepad/gamepad.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <libevdev/libevdev.h>

namespace cargobay::gamepad {

namespace {

constexpr double kMiddle = 0.1;

int value(const libevdev* device, unsigned type, unsigned code) {
  int now = 0;
  // 0 if the device has no such thing.
  return libevdev_fetch_event_value(device, type, code, &now) != 0 ? now : 0;
}

}  // namespace

bool Gamepad::is_one(const libevdev* device) {
  const bool stick = libevdev_has_event_code(device, EV_ABS, ABS_X) != 0 &&
                     libevdev_has_event_code(device, EV_ABS, ABS_Y) != 0;
  const bool shoulder = libevdev_has_event_code(device, EV_KEY, BTN_TL) != 0 ||
                        libevdev_has_event_code(device, EV_KEY, BTN_TR) != 0;
  return stick && shoulder;
}

bool Gamepad::is_held() const {
  return value(device_, EV_KEY, BTN_TL) != 0 || value(device_, EV_KEY, BTN_TR) != 0;
}

// Of its range, whatever that is: -1 to 1.
double Gamepad::part(unsigned axis) const {
  const double least = libevdev_get_abs_minimum(device_, axis);
  const double most = libevdev_get_abs_maximum(device_, axis);
  if (!(most > least)) return 0.0;
  const double place = 2.0 * (value(device_, EV_ABS, axis) - least) / (most - least) - 1.0;
  const double beyond = std::clamp((std::abs(place) - kMiddle) / (1.0 - kMiddle), 0.0, 1.0);
  return std::copysign(beyond, place);
}

Stick Gamepad::stick() const {
  // Both axes of evdev point right and down.
  return {.forward = -part(ABS_Y), .turn = -part(ABS_X)};
}

std::string Gamepad::line(Time now) const {
  if (!is_held()) return "stand";
  if (is_silent(now)) return "silent";
  const Stick place = stick();
  std::array<char, 64> text{};
  // + 0.0: there is no "-0.000".
  const int size = std::snprintf(text.data(), text.size(), "drive %.3f %.3f", place.forward + 0.0,
                                 place.turn + 0.0);
  return {text.data(), static_cast<std::size_t>(std::max(size, 0))};
}

}  // namespace cargobay::gamepad
