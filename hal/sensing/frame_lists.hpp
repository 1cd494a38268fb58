// The lists of packets that the loop streams, one at a time. All make frames of the same length, so
// that one wake-up threshold serves any of them; for why it is 16 bytes, see docs/decisions/0005.
#pragma once

#include <cstdint>
#include <optional>

#include "oi/bit_set.hpp"
#include "oi/commands.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_budget.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

enum class FrameList : std::uint8_t {
  reading,  // reads the counters for distance and angle
  hazards,  // cliffs and overcurrents
  battery,
  // Only on request:
  signals_left,   // wall, cliffs left and front left, as strengths
  signals_right,  // cliffs front right and right, the inputs of the cargo bay
  outputs,        // what the robot was told: songs, stream, speeds
};

// Every frame carries the OI mode: only the robot knows its mode.
//
// Distance and angle, with the infrared byte and the buttons; also wheel drops and the charger,
// since no frame has room for both cliffs and charger.
inline constexpr oi::StreamList kReadingList = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::group_2, oi::PacketId::bumps_and_wheel_drops,
    oi::PacketId::charging_sources);
// Bumps, wheel drops, walls, cliffs, overcurrents.
inline constexpr oi::StreamList kHazardList =
    oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(oi::PacketId::oi_mode, oi::PacketId::group_1);
// Charging state, voltage, current, temperature, charge, capacity.
inline constexpr oi::StreamList kBatteryList =
    oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(oi::PacketId::oi_mode, oi::PacketId::group_3);
inline constexpr oi::StreamList kSignalsLeftList = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::wall_signal, oi::PacketId::cliff_left_signal,
    oi::PacketId::cliff_front_left_signal, oi::PacketId::bumps_and_wheel_drops);
inline constexpr oi::StreamList kSignalsRightList =
    oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
        oi::PacketId::oi_mode, oi::PacketId::cliff_front_right_signal,
        oi::PacketId::cliff_right_signal, oi::PacketId::digital_inputs,
        oi::PacketId::analog_signal);
// Includes the mode.
inline constexpr oi::StreamList kOutputsList =
    oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(oi::PacketId::group_5);

inline constexpr std::size_t kFrameBytes = oi::frame_bytes(kReadingList);
static_assert(kFrameBytes == oi::frame_bytes(kHazardList));
static_assert(kFrameBytes == oi::frame_bytes(kBatteryList));
static_assert(kFrameBytes == oi::frame_bytes(kSignalsLeftList));
static_assert(kFrameBytes == oi::frame_bytes(kSignalsRightList));
static_assert(kFrameBytes == oi::frame_bytes(kOutputsList));
// A multiple of half the PL011's FIFO, on every Raspberry Pi: no wait for its receive time-out.
static_assert(kFrameBytes % oi::kPl011HalfFifoPi0To3 == 0);
static_assert(kFrameBytes % oi::kPl011HalfFifoPi4And5 == 0);

constexpr const oi::StreamList& packets(FrameList list) {
  switch (list) {
    case FrameList::reading: return kReadingList;
    case FrameList::hazards: return kHazardList;
    case FrameList::battery: return kBatteryList;
    case FrameList::signals_left: return kSignalsLeftList;
    case FrameList::signals_right: return kSignalsRightList;
    case FrameList::outputs: return kOutputsList;
  }
  return kReadingList;
}

// The list of a frame with these values; nothing for any other frame of the same length.
inline std::optional<FrameList> list_of(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  using enum oi::PacketId;
  if (!frame.has(oi_mode)) return std::nullopt;
  if (frame.has(distance) && frame.has(charging_sources)) return FrameList::reading;
  if (frame.has(overcurrents)) return FrameList::hazards;
  if (frame.has(battery_capacity)) return FrameList::battery;
  if (frame.has(wall_signal)) return FrameList::signals_left;
  if (frame.has(cliff_right_signal)) return FrameList::signals_right;
  if (frame.has(requested_left_velocity)) return FrameList::outputs;
  return std::nullopt;
}

// Those that are streamed only on request, in the order of FrameList.
enum class ExtraList : std::uint8_t { signals_left, signals_right, outputs };
using ExtraLists = oi::BitSet<ExtraList>;
inline constexpr int kExtraLists = 3;
inline constexpr ExtraLists kAllExtraLists{(1U << kExtraLists) - 1U};

constexpr FrameList list_of_extra(ExtraList extra) {
  return static_cast<FrameList>(static_cast<unsigned>(FrameList::signals_left) +
                                static_cast<unsigned>(extra));
}

}  // namespace cargobay::hal
