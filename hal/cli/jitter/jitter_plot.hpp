// The results of one or more runs of `cargobay jitter` as an SVG drawing.
#pragma once

#include <string>
#include <vector>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

// Above, the percentile curve of each channel, latency over rarity; below, the histograms; both
// logarithmic. A channel has its colour, and a run its dash; a legend names them.
std::string jitter_plot(const std::vector<JitterSummary>& runs, const std::string& title);

}  // namespace cargobay::cli
