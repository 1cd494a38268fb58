#include "hal/feed/message/packet_json.hpp"

#include <array>
#include <charconv>
#include <string_view>

#include "oi/dialect.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {

void append_json(std::string& out, oi::PacketId packet, std::int32_t raw) {
  const std::string_view key = oi::kCreate.packet(packet).key;
  std::array<char, 16> digits{};
  char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), raw).ptr;
  ((out += ",\"") += key) += "\":";
  out.append(digits.data(), end);
  if (const std::string_view name = oi::code_name(packet, raw); !name.empty())
    ((((out += ",\"") += key) += "_name\":\"") += name) += '"';
  if (!oi::is_bit_set(packet)) return;
  ((out += ",\"") += key) += "_names\":[";
  const char* quote = "\"";
  oi::visit_bits(packet, raw, [&](std::string_view name) {
    ((out += quote) += name) += '"';
    quote = ",\"";
  });
  out += ']';
}

}  // namespace cargobay::hal
