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

std::string_view name(ChargingState state) {
  switch (state) {
    case ChargingState::not_charging: return "not charging";
    case ChargingState::reconditioning: return "reconditioning charging";
    case ChargingState::full: return "full charging";
    case ChargingState::trickle: return "trickle charging";
    case ChargingState::waiting: return "waiting";
    case ChargingState::fault: return "charging fault";
  }
  return "unknown";
}

std::string_view name(InfraredCharacter character) {
  switch (character) {
    using enum InfraredCharacter;
    case remote_left: return "remote left";
    case remote_forward: return "remote forward";
    case remote_right: return "remote right";
    case remote_spot: return "remote spot";
    case remote_max: return "remote max";
    case remote_small: return "remote small";
    case remote_medium: return "remote medium";
    case remote_large_clean: return "remote large / clean";
    case remote_pause: return "remote pause";
    case remote_power: return "remote power";
    case remote_arc_forward_left: return "remote arc forward left";
    case remote_arc_forward_right: return "remote arc forward right";
    case remote_drive_stop: return "remote drive stop";
    case scheduling_remote_send_all: return "scheduling remote send all";
    case scheduling_remote_seek_dock: return "scheduling remote seek dock";
    case home_base_reserved: return "home base reserved";
    case home_base_force_field: return "home base force field";
    case home_base_green_buoy: return "home base green buoy";
    case home_base_green_buoy_and_force_field: return "home base green buoy and force field";
    case home_base_red_buoy: return "home base red buoy";
    case home_base_red_buoy_and_force_field: return "home base red buoy and force field";
    case home_base_red_and_green_buoy: return "home base red and green buoy";
    case home_base_red_and_green_buoy_and_force_field:
      return "home base red and green buoy and force field";
    case none: return "none";
  }
  return "unknown";
}

std::string_view bit_name(PacketId packet, unsigned bit) {
  using Names = std::array<std::string_view, 5>;
  static constexpr Names kBumps{"bump_right", "bump_left", "wheel_drop_right", "wheel_drop_left",
                                "wheel_drop_front"};
  static constexpr Names kOvercurrents{"low_side_driver_1", "low_side_driver_0",
                                       "low_side_driver_2", "right_wheel", "left_wheel"};
  static constexpr Names kButtons{"play", "", "advance", "", ""};
  static constexpr Names kInputs{"input_0", "input_1", "input_2", "input_3", "device_detect"};
  static constexpr Names kSources{"internal_charger", "home_base", "", "", ""};
  if (bit >= 5) return "";
  switch (packet) {
    case PacketId::bumps_and_wheel_drops: return kBumps[bit];
    case PacketId::overcurrents: return kOvercurrents[bit];
    case PacketId::buttons: return kButtons[bit];
    case PacketId::digital_inputs: return kInputs[bit];
    case PacketId::charging_sources: return kSources[bit];
    default: return "";
  }
}

}  // namespace cargobay::oi
