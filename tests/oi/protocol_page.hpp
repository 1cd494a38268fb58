// docs/protocol.md, made from the tables of oi/.
#pragma once

#include <string>

namespace cargobay::oi {

// The whole page. What no table knows, such as where the manual contradicts itself, is written
// down in protocol_page.cpp.
std::string protocol_page();

}  // namespace cargobay::oi
