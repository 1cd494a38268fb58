// docs/protocol.md, made from the tables of oi/.
#pragma once

#include <string>

namespace cargobay::oi {

// The whole page; what no table contains is in protocol_text.hpp.
std::string protocol_page();

}  // namespace cargobay::oi
