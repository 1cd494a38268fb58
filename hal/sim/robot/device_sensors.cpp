// What each packet reads (OI p. 17 to 21). Sensors have the values of the last tick; what the robot
// knows about itself (packets 35 to 42) is current.
#include <cmath>

#include "hal/sim/robot/device.hpp"
#include "oi/dialect.hpp"
#include "oi/extensions.hpp"

namespace cargobay::hal::sim {

namespace {

template <typename Flag>
constexpr std::int32_t bit(bool set, Flag flag) {
  return set ? oi::BitSet<Flag>{}.with(flag).raw() : 0;
}

std::int32_t raw_count(std::int64_t edges) { return static_cast<std::uint16_t>(edges); }
std::int32_t rounded(double value) { return static_cast<std::int32_t>(std::lround(value)); }

}  // namespace

// Sends as far as the line has room, and continues at the next tick: a reply arrives whole, however
// long (255 times group 6 takes 2.3 s at 57600).
void Device::reply() {
  while (reply_.under_way() && serial_.output.room() >= kLongestPart) {
    const std::uint8_t part = reply_.front();
    reply_.is_packet() ? send_packet(part) : send(part);
    reply_.pop();
  }
}

// Sends nothing for an id that is not a packet.
void Device::send_packet(std::uint8_t id) {
  const oi::PacketInfo* info = parameters_.dialect->find_packet(id);
  if (info == nullptr) return;
  for (std::uint8_t single = info->first; single <= info->last; ++single) {
    const auto raw = static_cast<std::uint32_t>(read_sensor(single));
    if (parameters_.dialect->packet_size(single) == 2) {
      send(static_cast<std::uint8_t>(raw >> 8U));
    }
    send(static_cast<std::uint8_t>(raw));
  }
}

std::int32_t Device::read_sensor(std::uint8_t id) {
  const auto packet = static_cast<oi::PacketId>(id);
  if (packet == oi::kRawLeftCount) return raw_count(chassis_.wheels.left().edges());
  if (packet == oi::kRawRightCount) return raw_count(chassis_.wheels.right().edges());
  switch (packet) {
    case oi::PacketId::bumps_and_wheel_drops:
      return bit(seen_.bump_right, oi::Bump::bump_right) |
             bit(seen_.bump_left, oi::Bump::bump_left) |
             bit(seen_.wheel_drop_right, oi::Bump::wheel_drop_right) |
             bit(seen_.wheel_drop_left, oi::Bump::wheel_drop_left) |
             bit(seen_.wheel_drop_caster, oi::Bump::wheel_drop_front);
    case oi::PacketId::wall: return seen_.wall;
    case oi::PacketId::cliff_left: return seen_.cliff_left.cliff;
    case oi::PacketId::cliff_front_left: return seen_.cliff_front_left.cliff;
    case oi::PacketId::cliff_front_right: return seen_.cliff_front_right.cliff;
    case oi::PacketId::cliff_right: return seen_.cliff_right.cliff;
    case oi::PacketId::virtual_wall: return seen_.virtual_wall;
    case oi::PacketId::overcurrents:
      return bit(seen_.overcurrent_low_side_driver[0], oi::Overcurrent::low_side_driver_0) |
             bit(seen_.overcurrent_low_side_driver[1], oi::Overcurrent::low_side_driver_1) |
             bit(seen_.overcurrent_low_side_driver[2], oi::Overcurrent::low_side_driver_2) |
             bit(seen_.overcurrent_right_wheel, oi::Overcurrent::right_wheel) |
             bit(seen_.overcurrent_left_wheel, oi::Overcurrent::left_wheel);
    case oi::PacketId::infrared_byte: return seen_.infrared;
    case oi::PacketId::buttons:
      return bit(seen_.play_button, oi::Button::play) |
             bit(seen_.advance_button, oi::Button::advance);
    case oi::PacketId::distance: return junk_or(chassis_.odometer.take_distance().value);
    case oi::PacketId::angle: return junk_or(chassis_.odometer.take_angle().value);
    case oi::PacketId::charging_state: return static_cast<std::int32_t>(battery_.state());
    case oi::PacketId::voltage: return rounded(battery_.voltage_mv());
    case oi::PacketId::current: return rounded(battery_.current_ma());
    case oi::PacketId::battery_temperature: return rounded(battery_.temperature_deg_c());
    case oi::PacketId::battery_charge: return rounded(battery_.reported_charge_mah());
    case oi::PacketId::battery_capacity: return rounded(battery_.reported_capacity_mah());
    case oi::PacketId::wall_signal: return seen_.wall_signal;
    case oi::PacketId::cliff_left_signal: return seen_.cliff_left.signal;
    case oi::PacketId::cliff_front_left_signal: return seen_.cliff_front_left.signal;
    case oi::PacketId::cliff_front_right_signal: return seen_.cliff_front_right.signal;
    case oi::PacketId::cliff_right_signal: return seen_.cliff_right.signal;
    case oi::PacketId::digital_inputs:
      return bit(seen_.digital[0], oi::DigitalInput::input_0) |
             bit(seen_.digital[1], oi::DigitalInput::input_1) |
             bit(seen_.digital[2], oi::DigitalInput::input_2) |
             bit(seen_.digital[3], oi::DigitalInput::input_3) |
             bit(supply_.brc.high(), oi::DigitalInput::device_detect);
    case oi::PacketId::analog_signal: return seen_.analog;
    case oi::PacketId::charging_sources:
      return bit(seen_.charger, oi::ChargingSource::internal_charger) |
             bit(seen_.home_base, oi::ChargingSource::home_base);
    case oi::PacketId::oi_mode: return static_cast<std::int32_t>(mode_);
    case oi::PacketId::song_number: return songs_.selected();
    case oi::PacketId::song_playing: return songs_.playing();
    case oi::PacketId::stream_packets: return static_cast<std::int32_t>(stream_.packets().size());
    case oi::PacketId::requested_velocity: return requested_.velocity_mm_s;
    case oi::PacketId::requested_radius: return requested_.radius_mm;
    case oi::PacketId::requested_right_velocity: return requested_.right_mm_s;
    case oi::PacketId::requested_left_velocity: return requested_.left_mm_s;
    default: return 0;  // the unused packets
  }
}

// On real robots the first reading after connecting is junk: with that fault, one of each.
std::int32_t Device::junk_or(std::int32_t reading) {
  if (faults_.junk_readings == 0) return reading;
  --faults_.junk_readings;
  return static_cast<std::int16_t>(junk_.next());
}

}  // namespace cargobay::hal::sim
