#include "tests/oi/protocol_page.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/extensions.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_budget.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/text_writer.hpp"
#include "tests/oi/protocol_text.hpp"

namespace cargobay::oi {
namespace {

class Page {
 public:
  Page& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }
  Page& operator<<(std::int64_t number) {
    return *this << std::string_view{std::to_string(number)};
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

std::string choice(const ArgumentInfo& argument) {
  std::array<char, 2048> characters{};
  TextWriter text{characters};
  write_choice(text, argument);
  return std::string{text.text()};
}

std::string_view new_mode(ModeChange change) {
  switch (change) {
    case ModeChange::none: return "";
    case ModeChange::to_passive: return "Passive";
    case ModeChange::to_safe: return "Safe";
    case ModeChange::to_full: return "Full";
  }
  return "";
}

void add_baud_rates(Page& page) {
  page << "| code | baud | bytes in 15 ms | a DriveDirect takes |\n|---|---|---|---|\n";
  for (std::size_t code = 0; code < kBaudRates.size(); ++code) {
    const auto microseconds = command_time(kDriveDirectBytes, kBaudRates[code]).count() / 1000;
    page << "| " << static_cast<std::int64_t>(code) << " | " << kBaudRates[code] << " | "
         << static_cast<std::int64_t>(bytes_per_tick(kBaudRates[code])) << " | " << microseconds
         << " us |\n";
  }
}

// `radius` -2000 to 2000 mm ...
void add_argument(Page& page, const ArgumentInfo& argument) {
  page << "`" << argument.name << "`" << (argument.size == 2 ? " (2 bytes) " : " ");
  // The names of packets and events have their own tables.
  if (argument.name == "packet") {
    page << "0 to " << argument.max;
  } else if (argument.name == "event") {
    page << argument.min << " to " << argument.max << " but 0";
  } else {
    page << choice(argument);
  }
}

void add_commands(Page& page) {
  page << "| opcode | command | text form | data | from | then | OI p. "
          "|\n|---|---|---|---|---|---|---|\n";
  for (const CommandInfo& info : kCommands) {
    page << "| " << info.opcode << " | " << info.name << " | `" << info.key << "` | ";
    std::string_view separator;
    for (const ArgumentInfo& argument : info.arguments()) {
      page << separator;
      add_argument(page, argument);
      separator = "; ";
    }
    separator = "; then as often as that says: ";
    for (const ArgumentInfo& argument : element_arguments(info.tail)) {
      page << separator;
      add_argument(page, argument);
      separator = ", ";
    }
    page << " | "
         << (info.opcode == 128 ? "Off"
             : info.actuates    ? "Safe"
                                : "Passive")
         << " | " << new_mode(info.change) << " | " << info.page << " |\n";
  }
}

// The names of the values of one argument of a command.
void add_value_names(Page& page, std::string_view title, std::uint8_t opcode) {
  page << "\n| " << title << " | name |\n|---|---|\n";
  for (const ValueName& name : value_names(kCreate.find_command(opcode)->argument_slots[0])) {
    if (name.value > 0 || opcode != 158)
      page << "| " << name.value << " | `" << name.name << "` |\n";
  }
}

void add_groups_of(Page& page, std::uint8_t id) {
  std::string_view separator;
  for (std::uint8_t group = 0; group < kFirstSinglePacket; ++group) {
    if (id < kPackets[group].first || id > kPackets[group].last) continue;
    page << separator << group;
    separator = ", ";
  }
}

void add_packets(Page& page) {
  page << "| group | packets | bytes |\n|---|---|---|\n";
  for (std::uint8_t id = 0; id < kFirstSinglePacket; ++id) {
    page << "| " << id << " | " << kPackets[id].first << " to " << kPackets[id].last << " | "
         << kPackets[id].size << " |\n";
  }
  page << "\n| id | packet | key | bytes | range | unit | in groups "
          "|\n|---|---|---|---|---|---|---|\n";
  for (std::uint8_t id = kFirstSinglePacket; id <= kLastPacket; ++id) {
    const PacketInfo& info = kPackets[id];
    page << "| " << id << " | " << info.name << " | `" << info.key << "` | " << info.size
         << (info.is_signed ? ", signed" : "") << " | " << info.min << " to " << info.max << " | "
         << symbol(info.unit) << " | ";
    add_groups_of(page, id);
    page << " |\n";
  }
}

void add_bits(Page& page) {
  page << "\n| bit set | bit 0 | bit 1 | bit 2 | bit 3 | bit 4 |\n|---|---|---|---|---|---|\n";
  for (const PacketInfo& info : kPackets) {
    const auto id = PacketId{info.id};
    if (bit_name(id, 0).empty()) continue;
    page << "| " << info.id << " `" << info.key << "` |";
    for (unsigned bit = 0; bit < 5; ++bit) {
      const std::string_view name = bit_name(id, bit);
      page << (name.empty() ? " " : " `") << name << (name.empty() ? "|" : "` |");
    }
    page << "\n";
  }
}

void add_states(Page& page) {
  page << "\n| charging state | |\n|---|---|\n";
  for (std::uint8_t state = 0; state <= 5; ++state)
    page << "| " << state << " | " << name(ChargingState{state}) << " |\n";
  page << "\n| infrared byte | |\n|---|---|\n";
  for (unsigned byte = 0; byte < 256; ++byte) {
    const std::string_view what = name(InfraredCharacter{static_cast<std::uint8_t>(byte)});
    if (what != "unknown") page << "| " << byte << " | " << what << " |\n";
  }
}

void add_frame_lengths(Page& page) {
  page << "| list | frame | at 57600 | at 19200 |\n|---|---|---|---|\n";
  using enum PacketId;
  const auto add = [&page](std::string_view list, std::span<const PacketId> packets) {
    const std::size_t bytes = frame_bytes(packets);
    page << "| " << list << " | " << static_cast<std::int64_t>(bytes) << " bytes ";
    for (const std::uint32_t baud : {57600U, 19200U}) {
      page << "| " << wire_time(bytes, baud).count() / 1000 << " us"
           << (fits(packets, baud) ? " " : ": does not fit ");
    }
    page << "|\n";
  };
  add("`oi_mode`", std::array{oi_mode});
  add("`distance` `angle`", std::array{distance, angle});
  add("`distance` `angle` `oi_mode`", std::array{distance, angle, oi_mode});
  add("`group_6`", std::array{group_6});
}

void add_extensions(Page& page) {
  page
      << "\n## Outside the manual\n\nOff unless asked for (`oi/extensions.hpp`): `cargobay sim` "
         "and "
         "`decode` have `--extensions`,\n`encode` and `send` know `soft_reset` and "
         "`firmware_date`. "
         "`decode` names opcodes and packets of the\nCreate 2 and the Roombas as theirs; this "
         "robot "
         "ignores them.\n\n"
      << "| what | |\n|---|---|\n"
      << "| opcode " << kSoftResetOpcode
      << " | `soft_reset`: restarts the robot: 3 s of silence, 4 to 5 s in all; several sources |\n"
      << "| opcode " << kFirmwareDateOpcode << " | `firmware_date`: answers with "
      << static_cast<std::int64_t>(kFirmwareDateBytes)
      << " bytes: 18, year, month, day, hour, minute, and their exclusive or; one source |\n";
  for (const PacketInfo& info : std::span{kPacketsWithRawCounts}.subspan(kPacketCount)) {
    page << "| packet " << info.id << " | `" << info.key << "`: " << info.size
         << " bytes, counts up in both directions and wraps; 7.8324 counts a mm; firmware of "
            "2007-09-24, Query List only; one source |\n";
  }
}

}  // namespace

std::string protocol_page() {
  Page page;
  page << kIntroductionText << kLineText;
  add_baud_rates(page);
  page << kModesText;
  add_commands(page);
  page << kCommandNotesText;
  add_value_names(page, "demo", 136);
  add_value_names(page, "event", 158);
  page << kTunesText << kPacketsText;
  add_packets(page);
  add_bits(page);
  add_states(page);
  page << kStreamText;
  add_frame_lengths(page);
  page << kContradictionsText << kOpenText << kRobotsText;
  add_extensions(page);
  return std::move(page).text();
}

}  // namespace cargobay::oi
