// docs/protocol.md, made from the tables of oi/.
#pragma once

#include <string>

namespace cargobay::oi {

// The whole page. What no table contains, such as the manual's contradictions, is written in
// protocol_page.cpp.
std::string protocol_page();

}  // namespace cargobay::oi
