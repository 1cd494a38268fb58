// The results of `cargobay jitter` as text.
#pragma once

#include <string>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

enum class Bars : std::uint8_t { blocks, ascii };
// Blocks where the locale's character set has them.
Bars bars_of_locale();

// Headline, a row a channel with a small histogram, stages, ratios, conditions.
std::string table(const JitterSummary& summary, Bars bars);
// Each channel of all of them, against the first.
std::string comparison(const std::vector<JitterSummary>& all);

}  // namespace cargobay::cli
