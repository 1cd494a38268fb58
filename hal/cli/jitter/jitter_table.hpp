// The results of `cargobay jitter` as text.
#pragma once

#include <string>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

enum class Bars : std::uint8_t { blocks, ascii };
// Block characters if the locale's character set has them.
Bars bars_of_locale();

// Headline, one row per channel with a small histogram, stages, ratios, conditions.
std::string table(const JitterSummary& summary, Bars bars);

}  // namespace cargobay::cli
