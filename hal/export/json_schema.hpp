// What the JSON of a topic looks like, for programs.
#pragma once

#include <string>

#include "hal/columns/columns.hpp"

namespace cargobay::hal {

// The JSON schema (draft 7) of a topic's objects: types, units and meanings. None of the members is
// required.
std::string json_schema(const TopicInfo& topic);

}  // namespace cargobay::hal
