// The last frames before a drive ended by itself, as a table for people.
#pragma once

#include <span>
#include <string>

#include "hal/recording/exchange.hpp"

namespace cargobay::cli {

// One line an exchange, the times counted back from the last; waits in which nothing came are
// drawn together. Empty where there are none.
std::string last_frames_table(std::span<const hal::Exchange> exchanges);

}  // namespace cargobay::cli
