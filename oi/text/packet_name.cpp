#include "oi/text/packet_name.hpp"

#include "oi/packet_table.hpp"
#include "oi/text/text_number.hpp"

namespace cargobay::oi {

std::optional<std::uint8_t> packet_named(std::string_view key_or_number, const Dialect& dialect) {
  for (const PacketInfo& info : dialect.packets) {
    if (info.key == key_or_number) return info.id;
  }
  const std::optional<std::int32_t> number = parse_integer(key_or_number);
  if (!number || *number < 0 || *number >= static_cast<std::int64_t>(dialect.packets.size()))
    return std::nullopt;
  return static_cast<std::uint8_t>(*number);
}

}  // namespace cargobay::oi
