// The last frames before a drive ended by itself, as a table for people.
#pragma once

#include <span>
#include <string>

#include "hal/recording/exchange.hpp"

namespace cargobay::cli {

// One line per exchange, the times counted back from the last one; consecutive waits in which
// nothing came are merged. Empty if there are no exchanges.
std::string last_frames_table(std::span<const hal::Exchange> exchanges);

}  // namespace cargobay::cli
