// Any bytes through the command parser, byte by byte, and through parse_command: both divide them
// the same way, and each command is encoded to the same bytes again.
#include "oi/command_parser.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "oi/command.hpp"
#include "oi/dialect.hpp"
#include "oi/parse.hpp"

namespace {

using namespace cargobay::oi;  // NOLINT(google-build-using-namespace): the subject of this program

void require(bool condition) {
  if (!condition) std::abort();
}

void check_command(std::span<const std::uint8_t> bytes) {
  const ParseResult result = parse_command(bytes);
  require(result.length == bytes.size());
  switch (result.outcome) {
    case ParseResult::Outcome::command: {
      const auto encoded = encode(result.command);
      require(encoded.has_value() && std::ranges::equal(*encoded, bytes));
      break;
    }
    case ParseResult::Outcome::out_of_range:
      require(result.error.argument != nullptr &&
              !result.error.argument->accepts(result.error.value));
      break;
    case ParseResult::Outcome::unknown_opcode:
      require(kCreate.find_command(bytes[0]) == nullptr);
      break;
    case ParseResult::Outcome::incomplete: std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  CommandParser parser;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto outcome = parser.push(data[i]);
    const std::span<const std::uint8_t> so_far{data + begin, i + 1 - begin};
    require(std::ranges::equal(parser.bytes(), so_far));
    if (outcome == CommandParser::Outcome::incomplete) {
      require(parser.needed() > 0 && parse_command(so_far).needed == parser.needed());
      continue;
    }
    require(parser.needed() == 0);
    check_command(so_far);
    begin = i + 1;
  }
  return 0;
}
