// What some robots answer although the manual does not mention it. Off unless asked for.
//
// Each from one published source: firmware of 2007-09-24 answers Query List for packets 43 and 44
// with the raw counts of the wheel encoders, and opcode 8 with its date. Several sources know
// opcode 7 as a soft reset.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "oi/command_table.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {

// Raw encoder counts: they count up in both directions and wrap at 65536.
inline constexpr PacketId kRawLeftCount{43};
inline constexpr PacketId kRawRightCount{44};
inline constexpr double kRawCountsPerMm = 7.8324;

// The manual's packets and these two.
inline constexpr std::array<PacketInfo, kPacketCount + 2> kPacketsWithRawCounts = [] {
  std::array<PacketInfo, kPacketCount + 2> packets{};
  std::copy(kPackets.begin(), kPackets.end(), packets.begin());
  packets[43] = detail::single(kRawLeftCount, 2, false, Unit::none, 0, 65535, "raw_left_count",
                               "Raw Left Count");
  packets[44] = detail::single(kRawRightCount, 2, false, Unit::none, 0, 65535, "raw_right_count",
                               "Raw Right Count");
  return packets;
}();

// How far a raw counter went between two readings; correct if it wrapped at most once.
constexpr std::uint16_t raw_count_difference(std::uint16_t before, std::uint16_t after) {
  return static_cast<std::uint16_t>(after - before);
}

// Restarts the robot's processor: silent for about 3 s, ready after 4 to 5 s.
inline constexpr std::uint8_t kSoftResetOpcode = 7;
// Asks for the date of the firmware.
inline constexpr std::uint8_t kFirmwareDateOpcode = 8;
inline constexpr std::size_t kFirmwareDateBytes = 7;

// The opcodes above, in text: without arguments.
struct ExtensionCommand {
  std::uint8_t opcode = 0;
  CommandInfo info{};        // key and name
  std::string_view meaning;  // for people
};
inline constexpr std::array<ExtensionCommand, 2> kExtensionCommands{{
    {kSoftResetOpcode, detail::command(kSoftResetOpcode, "soft_reset", "Soft Reset", 0),
     "restarts the robot"},
    {kFirmwareDateOpcode, detail::command(kFirmwareDateOpcode, "firmware_date", "Firmware Date", 0),
     "asks for the date of the firmware"},
}};

// Null if there is none.
constexpr const ExtensionCommand* find_extension(std::string_view key) {
  for (const ExtensionCommand& command : kExtensionCommands) {
    if (command.info.key == key) return &command;
  }
  return nullptr;
}
constexpr const ExtensionCommand* find_extension(std::uint8_t opcode) {
  for (const ExtensionCommand& command : kExtensionCommands) {
    if (command.opcode == opcode) return &command;
  }
  return nullptr;
}

struct FirmwareDate {
  std::uint8_t year = 0;  // of the century
  std::uint8_t month = 0;
  std::uint8_t day = 0;
  std::uint8_t hour = 0;
  std::uint8_t minute = 0;
  friend constexpr bool operator==(const FirmwareDate&, const FirmwareDate&) = default;
};

// Reads the answer to opcode 8: 18, year, month, day, hour, minute and the exclusive or of these.
// Nothing if it is not such an answer.
constexpr std::optional<FirmwareDate> parse_firmware_date(std::span<const std::uint8_t> answer) {
  if (answer.size() != kFirmwareDateBytes || answer[0] != 18) return std::nullopt;
  std::uint8_t check = 0;
  for (const std::uint8_t byte : answer) check = static_cast<std::uint8_t>(check ^ byte);
  if (check != 0) return std::nullopt;
  return FirmwareDate{answer[1], answer[2], answer[3], answer[4], answer[5]};
}

// The answer to opcode 8.
constexpr std::array<std::uint8_t, kFirmwareDateBytes> firmware_date_answer(
    const FirmwareDate& date) {
  std::array<std::uint8_t, kFirmwareDateBytes> answer{18,        date.year,   date.month, date.day,
                                                      date.hour, date.minute, 0};
  for (std::size_t i = 0; i + 1 < answer.size(); ++i) {
    answer.back() = static_cast<std::uint8_t>(answer.back() ^ answer[i]);
  }
  return answer;
}

}  // namespace cargobay::oi
