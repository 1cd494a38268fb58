#include <array>

#include "hal/columns/records.hpp"
#include "oi/dialect.hpp"
#include "oi/text/command_text.hpp"

namespace cargobay::hal {
namespace {

using Kind = ColumnInfo::Kind;
using CommandTable = Columns<CommandRecord>;

Value words(std::span<const std::uint8_t> command) {
  std::array<char, oi::kMaxCommandText> text{};
  const std::size_t length = oi::format_command(command, text);
  return length == 0 ? Value{} : Value{std::string{text.data(), length}};
}

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const std::uint8_t byte : bytes) {
    if (!out.empty()) out += ' ';
    (out += kDigits[byte >> 4U]) += kDigits[byte & 15U];
  }
  return out;
}

CommandTable make_command_columns() {
  CommandTable table = stamp_columns<CommandRecord>();
  table.push_back({{"opcode", Kind::whole, "", "Its first byte (OI p. 7)"},
                   [](const CommandRecord& record) -> Value {
                     if (record.bytes.empty()) return {};
                     return std::int64_t{record.bytes.front()};
                   }});
  table.push_back({{"command", Kind::text, "", "As `cargobay send` takes it"},
                   [](const CommandRecord& record) -> Value { return words(record.bytes); }});
  table.push_back({{"bytes", Kind::text, "", "In hexadecimal"},
                   [](const CommandRecord& record) -> Value { return hexadecimal(record.bytes); }});
  return table;
}

template <typename Record>
TopicInfo topic_info(std::string_view name, std::string_view meaning,
                     const Columns<Record>& columns) {
  TopicInfo info{.name = name, .meaning = meaning};
  for (const Column<Record>& column : columns) info.columns.push_back(&column);
  return info;
}

}  // namespace

const Columns<CommandRecord>& command_columns() {
  static const CommandTable kTable = make_command_columns();
  return kTable;
}

const TopicInfo& info(Topic topic) {
  static const std::array<TopicInfo, kTopics> kAll{
      topic_info("states", "The loop at each tick that had a frame", state_columns()),
      topic_info("sensors", "What a frame carried", sensor_columns()),
      topic_info("events", "What the loop noticed", event_columns()),
      topic_info("commands", "What was sent to the robot", command_columns())};
  return kAll[static_cast<std::size_t>(topic)];
}

std::string_view name(Topic topic) { return info(topic).name; }

}  // namespace cargobay::hal
