// The values of the Open Interface that the manual names, each with its one name: for text forms,
// JSON, messages and documentation.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "oi/commands.hpp"
#include "oi/sensors.hpp"

namespace cargobay::oi {

struct ValueName {
  constexpr ValueName() = default;
  template <typename Value>
  constexpr ValueName(Value named, std::string_view called)
      : name{called}, value{static_cast<std::int32_t>(named)} {}

  std::string_view name{};
  std::int32_t value = 0;
};

namespace detail {

// The names of consecutive values.
template <typename Enum, typename... Names>
constexpr auto names_from(Enum first, Names... names) {
  auto value = static_cast<std::int32_t>(first);
  return std::array{ValueName{value++, names}...};
}

}  // namespace detail

// The names of an enum's values; of flags, the values are the numbers of their bits.
template <typename Enum>
inline constexpr std::array<ValueName, 0> kValueNames{};

template <>
inline constexpr auto kValueNames<Mode> =
    detail::names_from(Mode::off, "off", "passive", "safe", "full");

template <>
inline constexpr auto kValueNames<StreamState> =
    detail::names_from(StreamState::pause, "pause", "resume");

template <>
inline constexpr auto kValueNames<DemoNumber> =
    detail::names_from(DemoNumber::abort, "abort", "cover", "cover_and_dock", "spot_cover", "mouse",
                       "drive_figure_eight", "wimp", "home", "tag", "pachelbel", "banjo");

// The name of an inverse is that of the event after "no_".
template <>
inline constexpr auto kValueNames<ScriptEvent> = detail::names_from(
    ScriptEvent::wheel_drop, "wheel_drop", "front_wheel_drop", "left_wheel_drop",
    "right_wheel_drop", "bump", "left_bump", "right_bump", "virtual_wall", "wall", "cliff",
    "left_cliff", "front_left_cliff", "front_right_cliff", "right_cliff", "home_base",
    "advance_button", "play_button", "digital_input_0", "digital_input_1", "digital_input_2",
    "digital_input_3", "mode_passive");

template <>
inline constexpr auto kValueNames<Led> =
    std::to_array<ValueName>({{Led::play, "play"}, {Led::advance, "advance"}});

template <>
inline constexpr auto kValueNames<LowSideDriver> =
    detail::names_from(LowSideDriver::driver_0, "driver_0", "driver_1", "driver_2");

template <>
inline constexpr auto kValueNames<DigitalOutput> =
    detail::names_from(DigitalOutput::output_0, "output_0", "output_1", "output_2");

template <>
inline constexpr auto kValueNames<Bump> =
    detail::names_from(Bump::bump_right, "bump_right", "bump_left", "wheel_drop_right",
                       "wheel_drop_left", "wheel_drop_front");

template <>
inline constexpr auto kValueNames<Overcurrent> =
    detail::names_from(Overcurrent::low_side_driver_1, "low_side_driver_1", "low_side_driver_0",
                       "low_side_driver_2", "right_wheel", "left_wheel");

template <>
inline constexpr auto kValueNames<Button> =
    std::to_array<ValueName>({{Button::play, "play"}, {Button::advance, "advance"}});

template <>
inline constexpr auto kValueNames<DigitalInput> = detail::names_from(
    DigitalInput::input_0, "input_0", "input_1", "input_2", "input_3", "device_detect");

template <>
inline constexpr auto kValueNames<ChargingSource> =
    detail::names_from(ChargingSource::internal_charger, "internal_charger", "home_base");

template <>
inline constexpr auto kValueNames<ChargingState> =
    detail::names_from(ChargingState::not_charging, "not charging", "reconditioning charging",
                       "full charging", "trickle charging", "waiting", "charging fault");

template <>
inline constexpr auto kValueNames<InfraredCharacter> = std::to_array<ValueName>(
    {{InfraredCharacter::remote_left, "remote left"},
     {InfraredCharacter::remote_forward, "remote forward"},
     {InfraredCharacter::remote_right, "remote right"},
     {InfraredCharacter::remote_spot, "remote spot"},
     {InfraredCharacter::remote_max, "remote max"},
     {InfraredCharacter::remote_small, "remote small"},
     {InfraredCharacter::remote_medium, "remote medium"},
     {InfraredCharacter::remote_large_clean, "remote large / clean"},
     {InfraredCharacter::remote_pause, "remote pause"},
     {InfraredCharacter::remote_power, "remote power"},
     {InfraredCharacter::remote_arc_forward_left, "remote arc forward left"},
     {InfraredCharacter::remote_arc_forward_right, "remote arc forward right"},
     {InfraredCharacter::remote_drive_stop, "remote drive stop"},
     {InfraredCharacter::scheduling_remote_send_all, "scheduling remote send all"},
     {InfraredCharacter::scheduling_remote_seek_dock, "scheduling remote seek dock"},
     {InfraredCharacter::home_base_reserved, "home base reserved"},
     {InfraredCharacter::home_base_force_field, "home base force field"},
     {InfraredCharacter::home_base_green_buoy, "home base green buoy"},
     {InfraredCharacter::home_base_green_buoy_and_force_field,
      "home base green buoy and force field"},
     {InfraredCharacter::home_base_red_buoy, "home base red buoy"},
     {InfraredCharacter::home_base_red_buoy_and_force_field, "home base red buoy and force field"},
     {InfraredCharacter::home_base_red_and_green_buoy, "home base red and green buoy"},
     {InfraredCharacter::home_base_red_and_green_buoy_and_force_field,
      "home base red and green buoy and force field"},
     {InfraredCharacter::none, "none"}});

template <typename Enum>
concept NamedEnum = !kValueNames<Enum>.empty();

// Empty if the value has no name.
constexpr std::string_view name_in(std::span<const ValueName> names, std::int32_t value) {
  for (const ValueName& each : names) {
    if (each.value == value) return each.name;
  }
  return {};
}

// The manual's name, in lower case; "unknown" for a value that it does not name.
template <NamedEnum Enum>
constexpr std::string_view name(Enum value) {
  const std::string_view known = name_in(kValueNames<Enum>, static_cast<std::int32_t>(value));
  return known.empty() ? "unknown" : known;
}

template <NamedEnum Enum>
constexpr std::optional<Enum> value_named(std::string_view name) {
  for (const ValueName& each : kValueNames<Enum>) {
    if (each.name == name) return static_cast<Enum>(each.value);
  }
  return std::nullopt;
}

// A single packet whose value is a code or a set of bits, each with a name.
struct NamedPacket {
  PacketId packet{};
  bool bits = false;
  std::span<const ValueName> names{};
};
inline constexpr std::array kNamedPackets{
    NamedPacket{PacketId::bumps_and_wheel_drops, true, kValueNames<Bump>},
    NamedPacket{PacketId::overcurrents, true, kValueNames<Overcurrent>},
    NamedPacket{PacketId::infrared_byte, false, kValueNames<InfraredCharacter>},
    NamedPacket{PacketId::buttons, true, kValueNames<Button>},
    NamedPacket{PacketId::charging_state, false, kValueNames<ChargingState>},
    NamedPacket{PacketId::digital_inputs, true, kValueNames<DigitalInput>},
    NamedPacket{PacketId::charging_sources, true, kValueNames<ChargingSource>},
    NamedPacket{PacketId::oi_mode, false, kValueNames<Mode>}};

constexpr const NamedPacket* find_named(PacketId packet) {
  for (const NamedPacket& each : kNamedPackets) {
    if (each.packet == packet) return &each;
  }
  return nullptr;
}

// The meaning of a packet's value if the packet is a code: "unknown" if the manual gives it none.
// Empty for any other packet.
constexpr std::string_view code_name(PacketId packet, std::int32_t value) {
  const NamedPacket* const named = find_named(packet);
  if (named == nullptr || named->bits) return {};
  const std::string_view known = name_in(named->names, value);
  return known.empty() ? "unknown" : known;
}

constexpr bool is_bit_set(PacketId packet) {
  const NamedPacket* const named = find_named(packet);
  return named != nullptr && named->bits;
}
// The name of one bit of a packet that is a bit set; empty if the manual gives it none.
constexpr std::string_view bit_name(PacketId packet, unsigned bit) {
  if (!is_bit_set(packet)) return {};
  return name_in(find_named(packet)->names, static_cast<std::int32_t>(bit));
}
// Calls `see(name)` for each bit of the packet's value that is set.
template <typename See>
constexpr void visit_bits(PacketId packet, std::int32_t value, See see) {
  for (unsigned bit = 0; bit < 8; ++bit) {
    if ((static_cast<std::uint32_t>(value) >> bit & 1U) == 0) continue;
    const std::string_view name = bit_name(packet, bit);
    see(name.empty() ? "unnamed bit" : name);
  }
}

}  // namespace cargobay::oi
