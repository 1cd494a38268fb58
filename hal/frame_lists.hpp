// The lists of packets that the loop streams, one at a time. All make frames of the same length, so
// one wake-up a frame serves any of them; why of 16 bytes: docs/decisions/0005.
#pragma once

#include <cstdint>

#include "oi/commands.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {

enum class FrameList : std::uint8_t {
  reading,  // reads the counters for distance and angle
  hazards,  // cliffs and overcurrents
  battery,
};

// The OI mode travels in every frame: the mode is the robot's to say.
//
// Distance and angle, with the infrared byte and the buttons; wheel drops and the charger, which no
// frame with cliffs and charger together has room for.
inline constexpr oi::StreamList kReadingList = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::group_2, oi::PacketId::bumps_and_wheel_drops,
    oi::PacketId::charging_sources);
// Bumps, wheel drops, walls, cliffs, overcurrents.
inline constexpr oi::StreamList kHazardList =
    oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(oi::PacketId::oi_mode, oi::PacketId::group_1);
// Charging state, voltage, current, temperature, charge, capacity.
inline constexpr oi::StreamList kBatteryList =
    oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(oi::PacketId::oi_mode, oi::PacketId::group_3);

inline constexpr std::size_t kFrameBytes = oi::frame_bytes(kReadingList);
static_assert(kFrameBytes == oi::frame_bytes(kHazardList));
static_assert(kFrameBytes == oi::frame_bytes(kBatteryList));
// Ends on the mark of the PL011's FIFO, on every Raspberry Pi: no wait for its time-out.
static_assert(kFrameBytes % oi::kPl011HalfFifoPi0To3 == 0);
static_assert(kFrameBytes % oi::kPl011HalfFifoPi4And5 == 0);

constexpr const oi::StreamList& packets(FrameList list) {
  switch (list) {
    case FrameList::reading: return kReadingList;
    case FrameList::hazards: return kHazardList;
    case FrameList::battery: return kBatteryList;
  }
  return kReadingList;
}

}  // namespace cargobay::hal
