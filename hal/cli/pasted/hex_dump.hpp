// Dumps with offsets: xxd (also -g, -u, -e, -b, -d), hexdump (also -C, -b, -c, -d), Wireshark, od
// (octal words, -x, -b, -c, -t x1, u1, d1, with z; -A x and d).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "hal/cli/terminal/operands.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

struct Dump {
  std::string_view form{};
  std::vector<std::uint8_t> bytes{};
};

// Nothing if the text is not such a dump. Offsets are checked against the bytes between them, and
// `*` is filled in. Three digits can be octal or decimal: `base` decides if nothing else does.
std::optional<hal::Result<Dump>> read_dump(std::string_view text, Base base);

}  // namespace cargobay::cli
