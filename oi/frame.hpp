// A stream frame: header 19, number n of the bytes between this one and the checksum, packet ids
// each followed by its data, checksum (OI p. 14).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/checksum.hpp"
#include "oi/limits.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {

inline constexpr std::size_t kFrameOverhead = 3;  // header, n, checksum
inline constexpr std::size_t kMinFrameBytes = 5;  // one packet of one byte

// How many bytes of a frame each id claims, itself included; 0 for an id that is not a packet.
using ItemSizes = std::array<std::uint8_t, 256>;

constexpr ItemSizes item_sizes(std::span<const PacketInfo> packets) {
  ItemSizes sizes{};
  for (const PacketInfo& info : packets) sizes[info.id] = static_cast<std::uint8_t>(1 + info.size);
  return sizes;
}

// Whether the bytes have the structure of one frame: header, length, and ids whose data fill it
// exactly. The checksum byte must be there; its value is not checked.
constexpr bool is_well_formed(std::span<const std::uint8_t> frame, const ItemSizes& sizes) {
  if (frame.size() < kMinFrameBytes || frame[0] != kFrameHeader) return false;
  if (frame[1] + kFrameOverhead != frame.size()) return false;
  std::size_t at = 2;
  while (at + 1 < frame.size()) {
    if (sizes[frame[at]] == 0) return false;
    at += sizes[frame[at]];
  }
  return at + 1 == frame.size();
}

}  // namespace cargobay::oi
