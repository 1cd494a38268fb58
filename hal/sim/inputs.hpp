// What the surroundings do to the robot: everything that its sensors would see. Set by the world, a
// test or the control socket; the robot reads it once a tick.
#pragma once

#include <array>
#include <cstdint>

#include "oi/sensors.hpp"

namespace cargobay::hal::sim {

struct CliffSensor {
  bool cliff = false;
  std::uint16_t signal = 1200;  // 0 to 4095: reflected light, high over floor
};

inline constexpr auto kNoInfrared = static_cast<std::uint8_t>(oi::InfraredCharacter::none);

struct Inputs {
  bool bump_left = false;
  bool bump_right = false;
  bool wheel_drop_left = false;
  bool wheel_drop_right = false;
  bool wheel_drop_caster = false;
  bool wall = false;
  std::uint16_t wall_signal = 0;  // 0 to 4095
  CliffSensor cliff_left{};
  CliffSensor cliff_front_left{};
  CliffSensor cliff_front_right{};
  CliffSensor cliff_right{};
  bool virtual_wall = false;
  std::uint8_t infrared = kNoInfrared;
  bool play_button = false;
  bool advance_button = false;
  std::array<bool, 4> digital{};
  std::uint16_t analog = 0;  // 0 to 1023
  bool overcurrent_left_wheel = false;
  bool overcurrent_right_wheel = false;
  std::array<bool, 3> overcurrent_low_side_driver{};
  bool charger = false;    // plugged in and powered
  bool home_base = false;  // docked on a powered Home Base

  // Of a Home Base.
  oi::HomeBaseBeams beams() const { return oi::home_base_beams(oi::InfraredCharacter{infrared}); }
  bool any_wheel_drop() const { return wheel_drop_left || wheel_drop_right || wheel_drop_caster; }
  bool any_cliff() const {
    return cliff_left.cliff || cliff_front_left.cliff || cliff_front_right.cliff ||
           cliff_right.cliff;
  }
};

}  // namespace cargobay::hal::sim
