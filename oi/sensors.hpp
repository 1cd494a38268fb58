// Sensor values: one number for each single packet, decoded from any packet, group or frame, and
// encoded again for the virtual Create.
//
// A value outside the manual's range is delivered as the robot sent it, and counted.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/bit_set.hpp"
#include "oi/checksum.hpp"
#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/frame.hpp"
#include "oi/packet_table.hpp"
#include "oi/units.hpp"

namespace cargobay::oi {

enum class Bump : std::uint8_t {  // packet 7
  bump_right = 0,
  bump_left = 1,
  wheel_drop_right = 2,
  wheel_drop_left = 3,
  wheel_drop_front = 4,
};
enum class Overcurrent : std::uint8_t {  // packet 14
  low_side_driver_1 = 0,                 // in this order: driver 1 before driver 0
  low_side_driver_0 = 1,
  low_side_driver_2 = 2,
  right_wheel = 3,
  left_wheel = 4,
};
enum class Button : std::uint8_t { play = 0, advance = 2 };  // packet 18
enum class DigitalInput : std::uint8_t {                     // packet 32
  input_0 = 0,
  input_1 = 1,
  input_2 = 2,
  input_3 = 3,
  device_detect = 4,  // the Baud Rate Change pin: low asks for 19200
};
enum class ChargingSource : std::uint8_t { internal_charger = 0, home_base = 1 };  // packet 34

enum class ChargingState : std::uint8_t {  // packet 21
  not_charging = 0,
  reconditioning = 1,
  full = 2,
  trickle = 3,
  waiting = 4,
  fault = 5,
};

// Packet 17: what the manual names. Any byte can arrive: Send IR sends any.
enum class InfraredCharacter : std::uint8_t {
  remote_left = 129,
  remote_forward = 130,
  remote_right = 131,
  remote_spot = 132,
  remote_max = 133,
  remote_small = 134,
  remote_medium = 135,
  remote_large_clean = 136,
  remote_pause = 137,
  remote_power = 138,
  remote_arc_forward_left = 139,
  remote_arc_forward_right = 140,
  remote_drive_stop = 141,
  scheduling_remote_send_all = 142,
  scheduling_remote_seek_dock = 143,
  home_base_reserved = 240,
  home_base_force_field = 242,
  home_base_green_buoy = 244,
  home_base_green_buoy_and_force_field = 246,
  home_base_red_buoy = 248,
  home_base_red_buoy_and_force_field = 250,
  home_base_red_and_green_buoy = 252,
  home_base_red_and_green_buoy_and_force_field = 254,
  none = 255,
};

// What a Home Base lights the receiver with: bits of its characters, which are the even ones from
// home_base_reserved on.
enum class HomeBaseBeam : std::uint8_t { force_field = 1, green_buoy = 2, red_buoy = 3 };
using HomeBaseBeams = BitSet<HomeBaseBeam>;
// None for a character that is not a Home Base's.
constexpr HomeBaseBeams home_base_beams(InfraredCharacter character) {
  const int bits =
      static_cast<int>(character) - static_cast<int>(InfraredCharacter::home_base_reserved);
  return HomeBaseBeams{bits < 0 || bits % 2 != 0 ? std::uint8_t{0}
                                                 : static_cast<std::uint8_t>(bits)};
}
constexpr InfraredCharacter infrared_character(HomeBaseBeams beams) {
  return InfraredCharacter{static_cast<std::uint8_t>(
      static_cast<unsigned>(InfraredCharacter::home_base_reserved) + beams.raw())};
}

class SensorValues {
 public:
  // Whether the single packet has been set. The accessors below give 0 for one that has not.
  constexpr bool has(PacketId packet) const { return (present_ & bit(packet)) != 0; }
  // Which have been set: one bit for each single packet, packet 7 being bit 0.
  constexpr std::uint64_t present() const { return present_; }
  constexpr std::int32_t raw(PacketId packet) const { return raw_[index(packet)]; }
  constexpr void set(PacketId packet, std::int32_t value) {
    raw_[index(packet)] = value;
    present_ |= bit(packet);
  }
  // Forgets all values, not the count below.
  constexpr void clear() {
    raw_ = {};
    present_ = 0;
  }
  // Calls `see(packet, raw value)` for each that has been set, in ascending order.
  template <typename See>
  constexpr void visit(See see) const {
    for (std::uint64_t rest = present_; rest != 0; rest &= rest - 1) {
      const auto slot = static_cast<std::size_t>(std::countr_zero(rest));
      see(PacketId{static_cast<std::uint8_t>(slot + kFirstSinglePacket)}, raw_[slot]);
    }
  }
  // How many decoded values have been outside the manual's range so far.
  constexpr std::uint64_t out_of_range() const { return out_of_range_; }
  constexpr void count_out_of_range() { ++out_of_range_; }

  constexpr BitSet<Bump> bumps_and_wheel_drops() const {
    return bits<Bump>(PacketId::bumps_and_wheel_drops);
  }
  constexpr bool wall() const { return flag(PacketId::wall); }
  constexpr bool cliff_left() const { return flag(PacketId::cliff_left); }
  constexpr bool cliff_front_left() const { return flag(PacketId::cliff_front_left); }
  constexpr bool cliff_front_right() const { return flag(PacketId::cliff_front_right); }
  constexpr bool cliff_right() const { return flag(PacketId::cliff_right); }
  constexpr bool virtual_wall() const { return flag(PacketId::virtual_wall); }
  constexpr BitSet<Overcurrent> overcurrents() const {
    return bits<Overcurrent>(PacketId::overcurrents);
  }
  constexpr InfraredCharacter infrared() const {
    return InfraredCharacter{byte(PacketId::infrared_byte)};
  }
  constexpr BitSet<Button> buttons() const { return bits<Button>(PacketId::buttons); }
  constexpr Mm distance() const { return Mm{raw(PacketId::distance)}; }
  constexpr Deg angle() const { return Deg{raw(PacketId::angle)}; }
  constexpr ChargingState charging_state() const {
    return ChargingState{byte(PacketId::charging_state)};
  }
  constexpr MilliVolt voltage() const { return MilliVolt{raw(PacketId::voltage)}; }
  constexpr MilliAmp current() const { return MilliAmp{raw(PacketId::current)}; }
  constexpr DegCelsius battery_temperature() const {
    return DegCelsius{raw(PacketId::battery_temperature)};
  }
  constexpr MilliAmpHour battery_charge() const {
    return MilliAmpHour{raw(PacketId::battery_charge)};
  }
  constexpr MilliAmpHour battery_capacity() const {
    return MilliAmpHour{raw(PacketId::battery_capacity)};
  }
  constexpr std::int32_t wall_signal() const { return raw(PacketId::wall_signal); }
  constexpr std::int32_t cliff_left_signal() const { return raw(PacketId::cliff_left_signal); }
  constexpr std::int32_t cliff_front_left_signal() const {
    return raw(PacketId::cliff_front_left_signal);
  }
  constexpr std::int32_t cliff_front_right_signal() const {
    return raw(PacketId::cliff_front_right_signal);
  }
  constexpr std::int32_t cliff_right_signal() const { return raw(PacketId::cliff_right_signal); }
  constexpr BitSet<DigitalInput> digital_inputs() const {
    return bits<DigitalInput>(PacketId::digital_inputs);
  }
  // 0 to 1023 for 0 to 5 V.
  constexpr std::int32_t analog_signal() const { return raw(PacketId::analog_signal); }
  constexpr BitSet<ChargingSource> charging_sources() const {
    return bits<ChargingSource>(PacketId::charging_sources);
  }
  constexpr Mode mode() const { return Mode{byte(PacketId::oi_mode)}; }
  constexpr std::int32_t song_number() const { return raw(PacketId::song_number); }
  constexpr bool song_playing() const { return flag(PacketId::song_playing); }
  constexpr std::int32_t stream_packets() const { return raw(PacketId::stream_packets); }
  constexpr MmPerSec requested_velocity() const {
    return MmPerSec{raw(PacketId::requested_velocity)};
  }
  constexpr Mm requested_radius() const { return Mm{raw(PacketId::requested_radius)}; }
  constexpr MmPerSec requested_right_velocity() const {
    return MmPerSec{raw(PacketId::requested_right_velocity)};
  }
  constexpr MmPerSec requested_left_velocity() const {
    return MmPerSec{raw(PacketId::requested_left_velocity)};
  }

 private:
  static constexpr std::size_t kSlots = kPacketsWithRawCounts.size() - kFirstSinglePacket;
  static_assert(kSlots <= 64);

  static constexpr std::size_t index(PacketId packet) {
    const auto id = static_cast<std::size_t>(packet);
    assert(id >= kFirstSinglePacket && id < kPacketsWithRawCounts.size());
    return id - kFirstSinglePacket;
  }
  static constexpr std::uint64_t bit(PacketId packet) { return std::uint64_t{1} << index(packet); }
  constexpr std::uint8_t byte(PacketId packet) const {
    return static_cast<std::uint8_t>(raw(packet));
  }
  constexpr bool flag(PacketId packet) const { return raw(packet) != 0; }
  template <typename Flag>
  constexpr BitSet<Flag> bits(PacketId packet) const {
    return BitSet<Flag>{byte(packet)};
  }

  std::array<std::int32_t, kSlots> raw_{};
  std::uint64_t present_ = 0;  // one bit for each slot
  std::uint64_t out_of_range_ = 0;
};

namespace detail {

constexpr std::int32_t read_value(const PacketInfo& info, std::span<const std::uint8_t> data) {
  if (info.size == 1) return info.is_signed ? static_cast<std::int8_t>(data[0]) : data[0];
  const auto word = static_cast<std::uint16_t>(data[0] << 8U | data[1]);
  return info.is_signed ? static_cast<std::int16_t>(word) : word;
}

constexpr void decode_known(const PacketInfo& info, std::span<const std::uint8_t> data,
                            SensorValues& values, const Dialect& dialect) {
  std::size_t at = 0;
  for (std::uint8_t id = info.first; id <= info.last; ++id) {
    const PacketInfo& member = dialect.packet(PacketId{id});
    const std::int32_t value = read_value(member, data.subspan(at));
    values.set(PacketId{id}, value);
    if (value < member.min || value > member.max) values.count_out_of_range();
    at += member.size;
  }
}

}  // namespace detail

// Both decoders are in the header because the control thread calls them: the compiler sees that
// they cannot block.

// Decodes the data of a packet or group. False, with nothing changed, if the id is not a packet or
// the data are not exactly its size.
[[nodiscard]] constexpr bool decode_packet(std::uint8_t id, std::span<const std::uint8_t> data,
                                           SensorValues& values, const Dialect& dialect = kCreate) {
  const PacketInfo* info = dialect.find_packet(id);
  if (info == nullptr || data.size() != info->size) return false;
  detail::decode_known(*info, data, values, dialect);
  return true;
}

// Decodes a whole frame, header to checksum, as a StreamDecoder returns it. False, with nothing
// changed, if its structure is wrong; the checksum is not checked again.
[[nodiscard]] constexpr bool decode_frame(std::span<const std::uint8_t> frame, SensorValues& values,
                                          const Dialect& dialect = kCreate) {
  if (!is_well_formed(frame, dialect.item_sizes)) return false;
  std::size_t at = 2;
  while (at + 1 < frame.size()) {
    const PacketInfo& info = dialect.packet(PacketId{frame[at]});
    detail::decode_known(info, frame.subspan(at + 1, info.size), values, dialect);
    at += 1U + info.size;
  }
  return true;
}

// Writes the data of a packet or group; a value that was never set is written as 0. Returns the
// bytes written: 0 if the id is not a packet or `out` is too short.
[[nodiscard]] std::size_t encode_packet(std::uint8_t id, const SensorValues& values,
                                        std::span<std::uint8_t> out,
                                        const Dialect& dialect = kCreate);

// Writes the frame of a stream list. Returns its bytes: 0 if the list is empty, has an id that is
// not a packet, needs more than the 255 bytes that a frame's length can state, or does not fit
// `out`.
[[nodiscard]] std::size_t encode_frame(std::span<const PacketId> packets,
                                       const SensorValues& values, Checksum form,
                                       std::span<std::uint8_t> out,
                                       const Dialect& dialect = kCreate);

}  // namespace cargobay::oi
