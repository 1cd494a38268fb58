#include "hal/cli/terminal/packet_list.hpp"

#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "oi/text/packet_name.hpp"

namespace cargobay::cli {

hal::Result<std::vector<oi::PacketId>> read_packet_list(const std::string& text,
                                                        const oi::Dialect& dialect) {
  std::vector<oi::PacketId> packets;
  std::istringstream words{text};
  std::string word;
  while (std::getline(words, word, ',')) {
    const std::optional<std::uint8_t> id = oi::packet_named(word, dialect);
    if (!id.has_value()) {
      return hal::Failure{
          fmt::format("'{}' is not a packet; write numbers from 0 to {} or names such as distance, "
                      "separated by commas",
                      word, dialect.packets.size() - 1)};
    }
    packets.push_back(static_cast<oi::PacketId>(*id));
  }
  if (packets.empty()) return hal::Failure{"the packet list is empty; write for example: 19,20,35"};
  return packets;
}

}  // namespace cargobay::cli
