#include "oi/parse.hpp"

#include <array>
#include <utility>
#include <variant>

namespace cargobay::oi {
namespace {

template <CommandStruct C>
void parse_as(std::span<const std::uint8_t> bytes, ParseResult& result) {
  detail::Reader reader{bytes};
  if (const std::optional<C> command = detail::read<C>(reader)) {
    result.outcome = ParseResult::Outcome::command;
    result.command.emplace<C>(*command);
  } else {
    result.outcome = ParseResult::Outcome::out_of_range;
    if (reader.error()) result.error = *reader.error();
  }
}

using ParseAs = void (*)(std::span<const std::uint8_t>, ParseResult&);

// In the order of kCommands.
constexpr std::array<ParseAs, kCommandCount> kParsers =
    []<std::size_t... kIndices>(std::index_sequence<kIndices...>) {
      static_assert(
          ((std::variant_alternative_t<kIndices, Command>::kOpcode == kCommands[kIndices].opcode) &&
           ...),
          "Command lists the commands in the order of the table");
      return std::array<ParseAs, kCommandCount>{
          parse_as<std::variant_alternative_t<kIndices, Command>>...};
    }(std::make_index_sequence<kCommandCount>{});
constexpr CommandIndex kIndex = index_of(kCommands);

}  // namespace

ParseResult parse_command(std::span<const std::uint8_t> bytes, const Dialect& dialect) {
  ParseResult result;
  if (bytes.empty()) {
    result.needed = 1;
    return result;
  }
  result.info = dialect.find_command(bytes[0]);
  if (result.info == nullptr) {
    result.outcome = ParseResult::Outcome::unknown_opcode;
    result.length = 1;
    return result;
  }
  const std::size_t length = command_length(*result.info, bytes);
  const std::size_t least = length != 0 ? length : 1 + result.info->argument_bytes();
  if (bytes.size() < least) {
    result.needed = least - bytes.size();
    return result;
  }
  result.length = length;
  kParsers[kIndex[bytes[0]]](bytes.first(length), result);
  return result;
}

}  // namespace cargobay::oi
