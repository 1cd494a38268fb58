// The lists of packets that the loop streams, one at a time. All lists of a robot make frames of
// the same length, so that one wake-up threshold serves any of them; for why it is 16 bytes, see
// docs/decisions/0005.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "oi/commands.hpp"

namespace cargobay::oi {

enum class FrameList : std::uint8_t {
  reading,  // reads the counters for distance and angle
  hazards,  // cliffs and overcurrents
  battery,
  // Only on request:
  signals_left,   // wall, cliffs left and front left, as strengths
  signals_right,  // cliffs front right and right, the inputs of the cargo bay
  outputs,        // what the robot was told: songs, stream, speeds
  // Each reads only one counter, of a robot that loses what a reading leaves over:
  distance,          // with the infrared byte
  distance_buttons,  // with the buttons: no list of five packets has room for both
  angle,
};
inline constexpr std::size_t kFrameLists = 9;
using FrameLists = std::array<StreamList, kFrameLists>;

// No list has more packets.
inline constexpr std::size_t kMostListed = 5;

// Every frame carries the OI mode: only the robot knows its mode.
inline constexpr FrameLists kCreateFrameLists = [] {
  using enum PacketId;
  constexpr auto list = [](auto... packets) {
    return list_of<PacketId, kMaxStreamPackets>(packets...);
  };
  return FrameLists{
      // Distance and angle, with the infrared byte and the buttons; also wheel drops and the
      // charger, since no frame has room for both cliffs and charger.
      list(oi_mode, group_2, bumps_and_wheel_drops, charging_sources),
      // Bumps, wheel drops, walls, cliffs, overcurrents.
      list(oi_mode, group_1),
      // Charging state, voltage, current, temperature, charge, capacity.
      list(oi_mode, group_3),
      list(oi_mode, wall_signal, cliff_left_signal, cliff_front_left_signal, bumps_and_wheel_drops),
      list(oi_mode, cliff_front_right_signal, cliff_right_signal, digital_inputs, analog_signal),
      // Includes the mode.
      list(group_5),
      list(oi_mode, PacketId::distance, infrared_byte, voltage, current),
      list(oi_mode, PacketId::distance, buttons, voltage, current),
      list(oi_mode, PacketId::angle, bumps_and_wheel_drops, voltage, current),
  };
}();

}  // namespace cargobay::oi
