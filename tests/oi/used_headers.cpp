// Instantiates what oi/ has only in headers, so that symbols_test.cpp can see what it needs.
#include <optional>
#include <span>
#include <variant>

#include "oi/command.hpp"
#include "oi/command_parser.hpp"
#include "oi/encode.hpp"
#include "oi/extensions.hpp"
#include "oi/parse.hpp"
#include "oi/stream_budget.hpp"
#include "oi/stream_decoder.hpp"
#include "oi/text_tail.hpp"

namespace cargobay::oi {

// NOLINTBEGIN(misc-use-internal-linkage): internal ones that nobody calls would not be compiled

unsigned use_decoder(StreamDecoder& decoder, TextTail& tail, std::uint8_t byte) {
  decoder.collect_text(&tail);
  unsigned frames = 0;
  for (auto outcome = decoder.push(byte); outcome != StreamDecoder::Outcome::nothing;
       outcome = decoder.next()) {
    frames += static_cast<unsigned>(decoder.frame().size());
  }
  while (decoder.abandon() != StreamDecoder::Outcome::nothing) ++frames;
  decoder.reset();
  return frames + static_cast<unsigned>(decoder.checksum().has_value());
}

std::size_t use_parser(CommandParser& parser, std::uint8_t byte) {
  if (parser.push(byte) == CommandParser::Outcome::incomplete) return parser.needed();
  const std::optional<DriveDirect> command = parse<DriveDirect>(parser.bytes());
  parser.reset();
  return command ? encode(*command)->size() : 0;
}

bool use_budget(std::span<const PacketId> packets, std::uint32_t baud) {
  return fits(packets, baud) &&
         control_delay(frame_bytes(packets), baud, kPl011HalfFifoPi0To3) < kTick;
}

std::optional<FirmwareDate> use_extensions(std::span<const std::uint8_t> answer) {
  return parse_firmware_date(answer);
}

// NOLINTEND(misc-use-internal-linkage)

}  // namespace cargobay::oi
