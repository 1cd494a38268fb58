// The 43 sensor packets of the Open Interface (OI p. 17 to 25), the one source for decoder,
// encoder, names, ranges and documentation. Programs look them up in a dialect (oi/dialect.hpp).
//
// Where the manual contradicts itself, this table says: packet 18 is bits 0 and 2 (0 to 5), packet
// 20 is in degrees, packet 35 is the OI mode, packet 38 goes to 43.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "oi/units.hpp"

namespace cargobay::oi {

// Packet ids by their names in the manual.
enum class PacketId : std::uint8_t {
  group_0 = 0,
  group_1 = 1,
  group_2 = 2,
  group_3 = 3,
  group_4 = 4,
  group_5 = 5,
  group_6 = 6,
  bumps_and_wheel_drops = 7,
  wall = 8,
  cliff_left = 9,
  cliff_front_left = 10,
  cliff_front_right = 11,
  cliff_right = 12,
  virtual_wall = 13,
  overcurrents = 14,
  unused_15 = 15,
  unused_16 = 16,
  infrared_byte = 17,
  buttons = 18,
  distance = 19,
  angle = 20,
  charging_state = 21,
  voltage = 22,
  current = 23,
  battery_temperature = 24,
  battery_charge = 25,
  battery_capacity = 26,
  wall_signal = 27,
  cliff_left_signal = 28,
  cliff_front_left_signal = 29,
  cliff_front_right_signal = 30,
  cliff_right_signal = 31,
  digital_inputs = 32,
  analog_signal = 33,
  charging_sources = 34,
  oi_mode = 35,
  song_number = 36,
  song_playing = 37,
  stream_packets = 38,
  requested_velocity = 39,
  requested_radius = 40,
  requested_right_velocity = 41,
  requested_left_velocity = 42,
};

inline constexpr std::size_t kPacketCount = 43;
inline constexpr std::uint8_t kFirstSinglePacket = 7;
inline constexpr std::uint8_t kLastPacket = 42;

struct PacketInfo {
  std::uint8_t id = 0;
  std::uint8_t size = 0;   // bytes on the wire, high byte first
  bool is_signed = false;  // two's complement
  Unit unit = Unit::none;
  std::int32_t min = 0;  // the manual's range; a robot may send anything the size allows
  std::int32_t max = 0;
  std::string_view key;    // name in code, options and JSON
  std::string_view name;   // name in the manual
  std::uint8_t first = 0;  // the single packets it consists of; itself if it is single
  std::uint8_t last = 0;

  constexpr bool is_group() const { return first != id; }
};

namespace detail {

constexpr PacketInfo single(PacketId id, std::uint8_t size, bool is_signed, Unit unit,
                            std::int32_t min, std::int32_t max, std::string_view key,
                            std::string_view name) {
  const auto number = static_cast<std::uint8_t>(id);
  return {number, size, is_signed, unit, min, max, key, name, number, number};
}

constexpr PacketInfo group(PacketId id, std::uint8_t size, std::string_view key,
                           std::string_view name, std::uint8_t first, std::uint8_t last) {
  return {static_cast<std::uint8_t>(id), size, false, Unit::none, 0, 0, key, name, first, last};
}

}  // namespace detail

// Indexed by packet id.
// clang-format off
inline constexpr std::array<PacketInfo, kPacketCount> kPackets = [] {
  using detail::group;
  using detail::single;
  using enum PacketId;
  return std::array<PacketInfo, kPacketCount>{{
    group(group_0, 26, "group_0", "Group 0", 7, 26),
    group(group_1, 10, "group_1", "Group 1", 7, 16),
    group(group_2,  6, "group_2", "Group 2", 17, 20),
    group(group_3, 10, "group_3", "Group 3", 21, 26),
    group(group_4, 14, "group_4", "Group 4", 27, 34),
    group(group_5, 12, "group_5", "Group 5", 35, 42),
    group(group_6, 52, "group_6", "Group 6", 7, 42),
    single(bumps_and_wheel_drops,    1, false, Unit::none, 0, 31, "bumps_and_wheel_drops", "Bumps and Wheel Drops"),
    single(wall,                     1, false, Unit::none, 0, 1, "wall", "Wall"),
    single(cliff_left,               1, false, Unit::none, 0, 1, "cliff_left", "Cliff Left"),
    single(cliff_front_left,         1, false, Unit::none, 0, 1, "cliff_front_left", "Cliff Front Left"),
    single(cliff_front_right,        1, false, Unit::none, 0, 1, "cliff_front_right", "Cliff Front Right"),
    single(cliff_right,              1, false, Unit::none, 0, 1, "cliff_right", "Cliff Right"),
    single(virtual_wall,             1, false, Unit::none, 0, 1, "virtual_wall", "Virtual Wall"),
    single(overcurrents,             1, false, Unit::none, 0, 31, "overcurrents", "Low Side Driver and Wheel Overcurrents"),
    single(unused_15,                1, false, Unit::none, 0, 0, "unused_15", "Unused"),
    single(unused_16,                1, false, Unit::none, 0, 0, "unused_16", "Unused"),
    single(infrared_byte,            1, false, Unit::none, 0, 255, "infrared_byte", "Infrared Byte"),
    single(buttons,                  1, false, Unit::none, 0, 5, "buttons", "Buttons"),
    single(distance,                 2, true,  Unit::mm, -32768, 32767, "distance", "Distance"),
    single(angle,                    2, true,  Unit::deg, -32768, 32767, "angle", "Angle"),
    single(charging_state,           1, false, Unit::none, 0, 5, "charging_state", "Charging State"),
    single(voltage,                  2, false, Unit::millivolt, 0, 65535, "voltage", "Voltage"),
    single(current,                  2, true,  Unit::milliamp, -32768, 32767, "current", "Current"),
    single(battery_temperature,      1, true,  Unit::deg_celsius, -128, 127, "battery_temperature", "Battery Temperature"),
    single(battery_charge,           2, false, Unit::milliamp_hour, 0, 65535, "battery_charge", "Battery Charge"),
    single(battery_capacity,         2, false, Unit::milliamp_hour, 0, 65535, "battery_capacity", "Battery Capacity"),
    single(wall_signal,              2, false, Unit::none, 0, 4095, "wall_signal", "Wall Signal"),
    single(cliff_left_signal,        2, false, Unit::none, 0, 4095, "cliff_left_signal", "Cliff Left Signal"),
    single(cliff_front_left_signal,  2, false, Unit::none, 0, 4095, "cliff_front_left_signal", "Cliff Front Left Signal"),
    single(cliff_front_right_signal, 2, false, Unit::none, 0, 4095, "cliff_front_right_signal", "Cliff Front Right Signal"),
    single(cliff_right_signal,       2, false, Unit::none, 0, 4095, "cliff_right_signal", "Cliff Right Signal"),
    single(digital_inputs,           1, false, Unit::none, 0, 31, "digital_inputs", "Cargo Bay Digital Inputs"),
    single(analog_signal,            2, false, Unit::none, 0, 1023, "analog_signal", "Cargo Bay Analog Signal"),
    single(charging_sources,         1, false, Unit::none, 0, 3, "charging_sources", "Charging Sources Available"),
    single(oi_mode,                  1, false, Unit::none, 0, 3, "oi_mode", "OI Mode"),
    single(song_number,              1, false, Unit::none, 0, 15, "song_number", "Song Number"),
    single(song_playing,             1, false, Unit::none, 0, 1, "song_playing", "Song Playing"),
    single(stream_packets,           1, false, Unit::none, 0, 43, "stream_packets", "Number of Stream Packets"),
    single(requested_velocity,       2, true,  Unit::mm_per_sec, -500, 500, "requested_velocity", "Requested Velocity"),
    single(requested_radius,         2, true,  Unit::mm, -32768, 32767, "requested_radius", "Requested Radius"),
    single(requested_right_velocity, 2, true,  Unit::mm_per_sec, -500, 500, "requested_right_velocity", "Requested Right Velocity"),
    single(requested_left_velocity,  2, true,  Unit::mm_per_sec, -500, 500, "requested_left_velocity", "Requested Left Velocity"),
  }};
}();
// clang-format on

// One bit for each single packet of an entry, packet 7 being bit 0.
constexpr std::uint64_t packet_bits(const PacketInfo& info) {
  std::uint64_t bits = 0;
  for (unsigned id = info.first; id <= info.last; ++id)
    bits |= std::uint64_t{1} << (id - kFirstSinglePacket);
  return bits;
}

}  // namespace cargobay::oi
