#include "oi/sensors.hpp"

#include "oi/frame.hpp"

namespace cargobay::oi {
std::size_t encode_packet(std::uint8_t id, const SensorValues& values, std::span<std::uint8_t> out,
                          const Dialect& dialect) {
  const PacketInfo* info = dialect.find_packet(id);
  if (info == nullptr || out.size() < info->size) return 0;
  std::size_t at = 0;
  for (std::uint8_t single = info->first; single <= info->last; ++single) {
    const auto raw = static_cast<std::uint32_t>(values.raw(PacketId{single}));
    if (dialect.packet(PacketId{single}).size == 2)
      out[at++] = static_cast<std::uint8_t>(raw >> 8U);
    out[at++] = static_cast<std::uint8_t>(raw);
  }
  return at;
}

std::size_t encode_frame(std::span<const PacketId> packets, const SensorValues& values,
                         Checksum form, std::span<std::uint8_t> out, const Dialect& dialect) {
  if (packets.empty() || out.size() < kMinFrameBytes) return 0;
  out = out.first(out.size() < kMaxFrameBytes ? out.size() : kMaxFrameBytes);
  std::size_t at = 2;
  for (const PacketId packet : packets) {
    const auto id = static_cast<std::uint8_t>(packet);
    if (at + 1 >= out.size()) return 0;
    const std::size_t size =
        encode_packet(id, values, out.subspan(at + 1, out.size() - at - 2), dialect);
    if (size == 0) return 0;
    out[at] = id;
    at += 1 + size;
  }
  out[0] = kFrameHeader;
  out[1] = static_cast<std::uint8_t>(at - 2);
  out[at] = checksum_of(out.first(at), form);
  return at + 1;
}

}  // namespace cargobay::oi
