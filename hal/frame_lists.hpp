// The two lists of packets that the loop streams: one reads the counters for distance and angle,
// the other does not. Both make frames of the same length, so one wake-up a frame serves both.
#pragma once

#include "oi/commands.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {

// The OI mode travels in every frame: the mode is the robot's to say.
inline constexpr oi::StreamList kReadingList = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::distance, oi::PacketId::angle);
inline constexpr oi::StreamList kWindowList = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::voltage, oi::PacketId::current);

inline constexpr std::size_t kFrameBytes = oi::frame_bytes(kReadingList);
static_assert(kFrameBytes == oi::frame_bytes(kWindowList));

}  // namespace cargobay::hal
