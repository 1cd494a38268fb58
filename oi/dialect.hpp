// A robot of the Open Interface family as a value: its packets, commands, rates and numbers. Codec,
// loop and virtual Create are given one. What all such robots share is not in it: the structure of
// a frame, the formats of numbers, the structs of oi/commands.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "oi/baud.hpp"
#include "oi/command_table.hpp"
#include "oi/extensions.hpp"
#include "oi/frame.hpp"
#include "oi/frame_list.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {

// Constants of static storage: whoever is given one keeps a pointer to it.
struct Dialect {
  std::span<const PacketInfo> packets;        // each at the index of its id
  std::span<const CommandInfo> commands;      // in the order of their opcodes
  std::span<const std::uint32_t> baud_rates;  // each at the index of its code, slowest first
  // Those that a robot may have been left at, likeliest first.
  std::span<const std::uint32_t> likely_rates;
  std::uint32_t default_baud = 0;  // after power-on
  std::uint32_t brc_baud = 0;      // after three pulses on the Baud Rate Change pin
  double wheel_base_mm = 0.0;
  // How far the robot went since they were last read, in mm and degrees.
  PacketId distance{};
  PacketId angle{};
  FrameLists frame_lists{};
  bool has_undocumented_opcodes = false;  // 7 and 8 (oi/extensions.hpp)

  // Made from the above, at compile time.
  ItemSizes item_sizes{};
  CommandIndex command_index{};
  std::array<std::uint64_t, kFrameLists> listed{};  // the single packets of each frame list
  std::size_t frame_bytes = 0;                      // of a frame of any of them

  // The packet's entry; null for an id that is not a packet.
  constexpr const PacketInfo* find_packet(std::uint8_t id) const {
    return id < packets.size() ? &packets[id] : nullptr;
  }
  // The entry of a packet that the robot has.
  constexpr const PacketInfo& packet(PacketId id) const {
    return packets[static_cast<std::size_t>(id)];
  }
  // Data bytes of the packet; 0 for an id that is not a packet.
  constexpr std::size_t packet_size(std::uint8_t id) const {
    return id < packets.size() ? packets[id].size : 0U;
  }

  // The command's entry; null for an opcode that the robot does not have.
  constexpr const CommandInfo* find_command(std::uint8_t opcode) const {
    const std::size_t index = command_index[opcode];
    return index < commands.size() ? &commands[index] : nullptr;
  }
  // The command's entry by its key; null if there is none.
  constexpr const CommandInfo* find_command(std::string_view key) const {
    for (const CommandInfo& info : commands) {
      if (info.key == key) return &info;
    }
    return nullptr;
  }

  // The code of a baud rate; nothing for a rate that the robot does not know.
  constexpr std::optional<std::uint8_t> baud_code(std::uint32_t baud) const {
    for (std::size_t code = 0; code < baud_rates.size(); ++code) {
      if (baud_rates[code] == baud) return static_cast<std::uint8_t>(code);
    }
    return std::nullopt;
  }

  constexpr bool is_likely(std::uint32_t baud) const {
    for (const std::uint32_t likely : likely_rates) {
      if (likely == baud) return true;
    }
    return false;
  }

  constexpr const StreamList& list(FrameList which) const {
    return frame_lists[static_cast<std::size_t>(which)];
  }
};

namespace detail {

constexpr std::size_t bytes_of_frame(const Dialect& dialect, std::span<const PacketId> list) {
  std::size_t bytes = kFrameOverhead;
  for (const PacketId packet : list) bytes += 1U + dialect.packet(packet).size;
  return bytes;
}

// Each entry is at the index of its id, and each group is as long as its members together.
constexpr bool in_order(std::span<const PacketInfo> packets) {
  for (std::size_t id = 0; id < packets.size(); ++id) {
    const PacketInfo& info = packets[id];
    std::size_t sum = 0;
    for (std::size_t member = info.first; info.is_group() && member <= info.last; ++member)
      sum += packets[member].size;
    if (info.id != id || (info.is_group() && sum != info.size)) return false;
  }
  return true;
}

}  // namespace detail

// Fills in what is made from the rest.
consteval Dialect complete(Dialect dialect) {
  dialect.item_sizes = oi::item_sizes(dialect.packets);
  dialect.command_index = index_of(dialect.commands);
  dialect.frame_bytes = detail::bytes_of_frame(dialect, dialect.frame_lists[0]);
  for (std::size_t i = 0; i < kFrameLists; ++i) {
    for (const PacketId packet : dialect.frame_lists[i])
      dialect.listed[i] |= packet_bits(dialect.packet(packet));
  }
  return dialect;
}

// Whether the tables are in order, and the frame lists make frames of the same length.
constexpr bool is_consistent(const Dialect& dialect) {
  for (const StreamList& list : dialect.frame_lists) {
    if (list.size() > kMostListed || detail::bytes_of_frame(dialect, list) != dialect.frame_bytes)
      return false;
  }
  return detail::in_order(dialect.packets);
}

namespace detail {

// The default, and those that hosts use.
inline constexpr std::array<std::uint32_t, 3> kLikelyRates{57600, 19200, 115200};

constexpr Dialect create(std::span<const PacketInfo> packets, bool has_undocumented_opcodes) {
  return {.packets = packets,
          .commands = kCommands,
          .baud_rates = kBaudRates,
          .likely_rates = kLikelyRates,
          .default_baud = 57600,
          .brc_baud = 19200,
          .wheel_base_mm = 258.0,  // what host software for this robot uses
          .distance = PacketId::distance,
          .angle = PacketId::angle,
          .frame_lists = kCreateFrameLists,
          .has_undocumented_opcodes = has_undocumented_opcodes};
}

}  // namespace detail

// The robot of the manual.
inline constexpr Dialect kCreate = complete(detail::create(kPackets, false));
// The same with what some robots answer although the manual does not mention it.
inline constexpr Dialect kCreateWithExtensions =
    complete(detail::create(kPacketsWithRawCounts, true));
static_assert(is_consistent(kCreate) && is_consistent(kCreateWithExtensions));

}  // namespace cargobay::oi
