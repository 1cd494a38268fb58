#include "hal/cli/words/word_lists.hpp"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "hal/cli/drive/profile.hpp"
#include "hal/port/serial_transport.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/fault_command.hpp"
#include "oi/dialect.hpp"
#include "oi/extensions.hpp"
#include "oi/packet_table.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/word_advice.hpp"

namespace cargobay::cli {
namespace {

std::vector<Word> ports() {
  std::vector<Word> words;
  for (const hal::PortInfo& port : hal::serial_ports()) {
    words.push_back({port.path, port.usb_product.empty() ? port.description : port.usb_product});
    if (!port.stable_path.empty()) words.push_back({port.stable_path, port.usb_product});
  }
  return words;
}

std::vector<Word> rates() {
  std::vector<Word> words{{"57600", "as the robot starts"}, {"19200", "as with Play held"}};
  for (const std::uint32_t rate : oi::kCreate.baud_rates) {
    const std::string text = fmt::format("{}", rate);
    if (text != words[0].text && text != words[1].text) words.push_back({text});
  }
  return words;
}

std::vector<Word> packets() {
  std::vector<Word> words;
  words.reserve(oi::kPackets.size());
  for (const oi::PacketInfo& packet : oi::kPackets)
    words.push_back({std::string{packet.key}, fmt::format("packet {}", words.size())});
  return words;
}

std::vector<Word> commands() {
  std::vector<Word> words{{std::string{oi::kStopKey}, "drive_direct 0 0"}};
  for (const oi::CommandInfo& info : oi::kCommands)
    words.push_back({std::string{info.key}, fmt::format("{} (OI p. {})", info.name, info.page)});
  words.push_back({std::string{oi::kTuneKey}, "a ring tone, as songs from a slot on"});
  words.push_back({std::string{oi::kRawBytesKey}, "any bytes"});
  for (const oi::ExtensionCommand& command : oi::kExtensionCommands) {
    words.push_back({std::string{command.info.key},
                     fmt::format("{}; only some robots know it", command.meaning)});
  }
  return words;
}

// Rows of a table, by name and meaning.
template <typename Rows>
std::vector<Word> rows(const Rows& table) {
  std::vector<Word> words;
  for (const auto& row : table) words.push_back({std::string{row.name}, std::string{row.meaning}});
  return words;
}

std::vector<Word> names_of(const oi::ArgumentInfo& argument) {
  std::vector<Word> words;
  for (const oi::ValueName& name : oi::value_names(argument))
    words.push_back({std::string{name.name}});
  return words;
}

// "TEXT:{a,b}" or "{a,b}": a and b.
std::vector<Word> listed_in(std::string_view choices) {
  const std::size_t open = choices.find('{');
  const std::size_t close = choices.find('}', std::min(open, choices.size()));
  if (close == std::string_view::npos) return {};
  std::vector<Word> words;
  for (std::size_t begin = open + 1; begin < close;) {
    const std::size_t end = std::min(choices.find(',', begin), close);
    words.push_back({std::string{choices.substr(begin, end - begin)}});
    begin = end + 1;
  }
  return words;
}

bool is_one_of(std::string_view name, std::span<const std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

// The argument that comes after so many operands of a command; null if none does.
const oi::ArgumentInfo* argument_after(const oi::CommandInfo& info, std::size_t given) {
  const std::size_t fixed = info.argument_count - (info.tail == oi::Tail::none ? 0U : 1U);
  if (given < fixed) return &info.argument_slots[oi::wire_place(info, given)];
  return info.tail == oi::Tail::packet_ids ? &oi::element_arguments(info.tail)[0] : nullptr;
}

}  // namespace

WordList words_of_option(std::string_view option, std::string_view choices) {
  constexpr std::array<std::string_view, 14> kFiles{
      "config", "json", "plot",   "record",     "link", "control", "world",
      "trace",  "hgrm", "output", "cyclictest", "csv",  "jsonl",   "mcap"};
  if (option == "port" || option == "live") return {.words = ports(), .files = true};
  if (option == "baud" || option == "boot-baud") return {.words = rates()};
  if (option == "packets") return {.words = packets(), .comma_listed = true};
  if (option == "fault") return {.words = rows(hal::sim::faults())};
  if (option == "plant") return {.words = rows(hal::sim::plants())};
  if (option == "profile") {
    WordList list{.files = true};
    for (const std::string_view name : Profile::names()) list.words.push_back({std::string{name}});
    return list;
  }
  if (option == "brc-line" || option == "power-line")
    return {.words = {{"rts", "of the port itself"}, {"dtr", "of the port itself"}}};
  if (option == "gamepad") return {.files = true};
  if (option == "learnt") return {.words = {{"none", "keep nothing"}}, .files = true};
  return {.words = listed_in(choices),
          .files = is_one_of(option, kFiles) || option == "write",
          .comma_listed = option == "channels" || option == "topics"};
}

WordList words_of_operand(std::string_view subcommand, std::span<const std::string> operands) {
  constexpr std::array<std::string_view, 5> kReaders{"replay", "plot", "export", "compare",
                                                     "decode"};
  if (is_one_of(subcommand, kReaders)) return {.files = true};
  if (subcommand != "send" && subcommand != "encode") return {};
  if (operands.empty() || operands.back().ends_with(';')) return {.words = commands()};
  // Those since the last separator.
  std::size_t begin = operands.size();
  while (begin > 0 && !operands[begin - 1].ends_with(';')) --begin;
  const oi::CommandInfo* const info = oi::kCreate.find_command(operands[begin]);
  if (info == nullptr) return {};
  const oi::ArgumentInfo* const argument = argument_after(*info, operands.size() - begin - 1);
  if (argument == nullptr) return {};
  return {.words = names_of(*argument),
          .comma_listed = oi::is_bit_set(*argument) || info->tail == oi::Tail::packet_ids};
}

}  // namespace cargobay::cli
