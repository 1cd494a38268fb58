// A packet's value as members of a JSON object.
#pragma once

#include <cstdint>
#include <string>

#include "oi/packet_table.hpp"

namespace cargobay::hal {

// Appends `,"KEY":RAW` and, for a code, `,"KEY_name":".."`, for bits `,"KEY_names":[..]`. All names
// are from tables, so that none needs escaping. Allocates.
void append_json(std::string& out, oi::PacketId packet, std::int32_t raw);

}  // namespace cargobay::hal
