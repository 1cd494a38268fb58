#include "oi/command.hpp"

#include "oi/encode.hpp"

namespace cargobay::oi {

std::optional<EncodedAnyCommand> encode(const Command& command) {
  return std::visit(
      [](const auto& one) -> std::optional<EncodedAnyCommand> {
        const auto bytes = encode(one);
        if (!bytes) return std::nullopt;
        EncodedAnyCommand any;
        if (!any.append(*bytes)) return std::nullopt;
        return any;
      },
      command);
}

}  // namespace cargobay::oi
