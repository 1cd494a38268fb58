// Frames as a robot sends them in Safe mode while it moves slowly and has nothing to report.
#pragma once

#include <array>
#include <cstdint>

#include "hal/sensing/frame_lists.hpp"
#include "oi/frame.hpp"
#include "oi/sensors.hpp"

namespace cargobay::hal::jitter {

using FrameBytes = std::array<std::uint8_t, oi::kCreate.frame_bytes>;

inline FrameBytes sample_frame(FrameList list) {
  oi::SensorValues values;
  for (std::uint8_t id = oi::kFirstSinglePacket; id <= oi::kLastPacket; ++id)
    values.set(oi::PacketId{id}, 0);
  values.set(oi::PacketId::oi_mode, static_cast<std::int32_t>(oi::Mode::safe));
  values.set(oi::PacketId::distance, 3);
  values.set(oi::PacketId::voltage, 16'000);
  values.set(oi::PacketId::battery_charge, 2'600);
  values.set(oi::PacketId::battery_capacity, 2'700);
  FrameBytes bytes{};
  (void)oi::encode_frame(oi::kCreate.list(list), values, oi::Checksum::including_header,
                         bytes);  // fits
  return bytes;
}

// One of each list.
inline std::array<FrameBytes, oi::kFrameLists> sample_frames() {
  std::array<FrameBytes, oi::kFrameLists> frames{};
  for (std::size_t i = 0; i < oi::kFrameLists; ++i)
    frames[i] = sample_frame(static_cast<FrameList>(i));
  return frames;
}

}  // namespace cargobay::hal::jitter
