// Packet lists as written on a command line: `29,13` or `cliff_front_left_signal,virtual_wall`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::cli {

// At least one packet of the dialect; a failure names the word that is not a packet.
hal::Result<std::vector<oi::PacketId>> read_packet_list(const std::string& text,
                                                        const oi::Dialect& dialect = oi::kCreate);

}  // namespace cargobay::cli
